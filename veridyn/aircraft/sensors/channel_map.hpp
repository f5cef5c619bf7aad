#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/recording/channel_map.hpp"
#include "veridyn/recording/channel_recognition.hpp"

namespace veridyn::aircraft {

using recording::ChannelOrigin;
using recording::MappedRecording;
using recording::require_channels;
using recording::StandardChannel;

/// Full throws of the surfaces [rad], to turn servo positions (-1..1) into deflections; from the subject.
struct SurfaceThrows {
  double elevator = 0.35;
  double aileron = 0.35;
  double rudder = 0.35;
  bool known = false;  ///< false: the values are the default, which the notes then say
};

/// Gives the channels of a log their standard names (the list is in docs/aircraft.md).
///
/// ArduPilot, PX4 and MAVLink logs are recognised by their messages and mapped through the tables in
/// `ardupilot_map.cpp`, `px4_map.cpp` and `mavlink_map.cpp`, recordings of ROS by the types of their topics
/// (`ros_map.cpp`); channels that already bear standard names are kept; keys
/// of `map` (the study's `[data.map]`, see recording::with_channel_map) come last and win.
///
/// What these leave is taken by the names of the literature (`channel_aliases`) where the unit is known.
///
/// A source that never changes (an unconnected sensor) is passed over, with a note.
/// @throws InputError for an unknown standard name (nearest suggested) or a source that the log lacks (lists what it
/// has).
[[nodiscard]] MappedRecording map_channels(const Recording& log, const StudyTable& map, const SurfaceThrows& throws);

/// Names of the literature and of other programs for standard channels: "p", "theta", "de", "VTAS".
[[nodiscard]] std::span<const recording::ChannelAlias> channel_aliases();

/// All standard names of aircraft recordings with their SI units.
[[nodiscard]] std::span<const StandardChannel> standard_channels();

}  // namespace veridyn::aircraft
