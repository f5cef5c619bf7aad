#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/recording/channel_map.hpp"

namespace veridyn::recording {

/// Another name under which people record a standard channel: "p" for gyro_x.
struct ChannelAlias {
  /// Small letters and digits only: "Yaw Rate" is "yawrate"; one letter as it is, a small one also for the capital of
  /// a channel that has a unit.
  std::string_view name;
  std::string_view channel;  ///< standard name
  std::string_view note{};   ///< what the name says besides: "true airspeed"
  bool open = false;         ///< it may be something else, as the note asks: not taken but by the study
  std::string_view less{};   ///< of a pair: the channel is half of `name` less this one
};

/// A channel of a log that is a standard channel by its name.
struct RecognisedChannel {
  std::string channel;  ///< standard name
  std::string source;   ///< name in the log
  std::string unit;     ///< of the numbers, where the log does not say it; "?" where nothing tells
  bool said = false;    ///< the log says the unit: by the end of the name, or a word with two meanings
  std::string why;      ///< how the unit is known, or what it may be; empty where the log says it
  std::string note;     ///< of the name
  bool open = false;    ///< the name alone does not decide
  std::string less;     ///< of a pair: the channel is half of source less this
};

/// What a log holds, by names.
struct Recognition {
  std::vector<RecognisedChannel> found;  ///< in the order of the standard channels, one for each
  std::vector<std::string> others;       ///< channels of the log that are none of these, nor mapped already
};

/// Finds the standard channels that `mapped` lacks among the channels of the log, by standard names without their unit
/// and by `aliases`, the first that fits. A channel whose unit is of another kind is passed over.
///
/// Where the log gives no unit, one at the end of the name ("V_mps") says it, or the numbers may: angles beyond a turn
/// are no radians, the median of a vertical acceleration is gravity. Else it is "?": nothing is guessed.
[[nodiscard]] Recognition recognise_channels(const Recording& log, const MappedRecording& mapped,
                                             std::span<const StandardChannel> standard,
                                             std::span<const ChannelAlias> aliases);

/// Adds the recognised channels, but those whose name leaves it open, whose unit the log says or the study declares
/// (`units` in `[data.map]`), each with a note that it was taken by its name; of those whose unit nothing says there is
/// one note for all. Keys of `map` are left to `with_channel_map`.
[[nodiscard]] MappedRecording with_recognised_channels(MappedRecording mapped, const Recording& log,
                                                       std::span<const StandardChannel> standard,
                                                       std::span<const ChannelAlias> aliases, const StudyTable& map);

/// `[data.map]` of a study about this log: a line for each recognised channel, with its unit to be confirmed, and
/// comments: what is mapped by itself, what was not found, which channels were not recognised.
[[nodiscard]] std::string map_section(const Recording& log, const MappedRecording& mapped,
                                      std::span<const StandardChannel> standard, std::span<const ChannelAlias> aliases);

}  // namespace veridyn::recording
