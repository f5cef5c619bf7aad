#pragma once

#include <functional>
#include <string>
#include <vector>

#include "veridyn/core/recording.hpp"

/// What is wrong with a recording, one thing at a time, whatever moves: for campaigns of faults.
namespace veridyn::test {

using ChannelNames = std::vector<std::string>;
using RecordingFault = std::function<void(Recording&)>;

/// Each channel by a function of itself.
void change_each(Recording& recording, const ChannelNames& names, const std::function<void(Channel&)>& change);

/// factor * value + offset
[[nodiscard]] RecordingFault scaled(ChannelNames names, double factor, double offset = 0.0);
/// The values of two channels of equal stamps change places.
[[nodiscard]] RecordingFault swapped(std::string first, std::string second);
/// New stamps as a function of the old ones.
[[nodiscard]] RecordingFault restamped(ChannelNames names, std::function<double(double)> stamp);
[[nodiscard]] RecordingFault delayed(ChannelNames names, double delay_s);
/// The first value of every so many seconds, repeated.
[[nodiscard]] RecordingFault held(ChannelNames names, double period_s);
/// Stands still for a share of the recording, from two fifths of it on.
[[nodiscard]] RecordingFault frozen(ChannelNames names, double share);
[[nodiscard]] RecordingFault clipped(ChannelNames names, double low, double high);
[[nodiscard]] RecordingFault quantised(ChannelNames names, double step);
/// `size` is added to one sample in `every`.
[[nodiscard]] RecordingFault with_spikes(ChannelNames names, double size, std::size_t every);
/// First-order low pass.
[[nodiscard]] RecordingFault smoothed(ChannelNames names, double time_constant_s);
/// What was recorded in a stretch of every so many seconds is lost, in all channels.
[[nodiscard]] RecordingFault with_gaps(double every_s, double length_s);
/// New stamps for all channels.
[[nodiscard]] RecordingFault with_clock(std::function<double(double)> stamp);

}  // namespace veridyn::test
