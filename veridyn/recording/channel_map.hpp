#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::recording {

/// A channel name that a domain understands without a map, and its SI unit.
struct StandardChannel {
  std::string name;
  std::string unit;
};

/// Where one standard channel came from, for the report.
struct ChannelOrigin {
  std::string channel;  ///< standard name, "airspeed"
  std::string source;   ///< "ARSP.Airspeed", "GPS.Spd, GPS.GCrs", "servo 2 (RCOU.C2)"
  double rate_Hz = 0.0;
  std::string note;  ///< what the reader should know: "indicated airspeed", "attitude of the autopilot's filter"
};

/// A recording in standard channel names (SI, one frame) and the account of how it was made.
struct MappedRecording {
  Recording recording;
  std::string log_kind;  ///< "ArduPilot", "PX4", "MAVLink", "standard names", "study"
  std::vector<ChannelOrigin> origins;
  std::vector<ChannelOrigin> left = {};  ///< other channels of the log that are the same quantity and were not taken
  /// Standard deviation that the calibration of a channel leaves, by channel: an error that all samples share.
  std::vector<std::pair<std::string, double>> calibration_sigma;
  std::vector<std::string> notes;  ///< sensors that are there but dead, estimates that were not taken for sensors, ...
};

/// What came with a recording, without its channels.
[[nodiscard]] Recording without_channels(const Recording& recording);

/// Channels of the log that bear standard names and that `map` does not name are taken as they are. One without a
/// unit is passed over with a note. @throws InputError where a unit is of another kind.
[[nodiscard]] MappedRecording with_standard_channels(MappedRecording mapped, const Recording& log,
                                                     std::span<const StandardChannel> standard, const StudyTable& map);

/// The keys of `[data.map]` besides standard names, and those of a channel that is made by a table.
struct ChannelMap {
  [[nodiscard]] static const KeyTable<ChannelMap>& keys();
};

/// Applies the study's `[data.map]`. A key is a standard name, its value the name of a channel or a table.
/// @throws InputError for an unknown standard name (nearest suggested) or a source that the log lacks (lists what it
/// has).
[[nodiscard]] MappedRecording with_channel_map(MappedRecording mapped, const Recording& log,
                                               std::span<const StandardChannel> standard, const StudyTable& map);

/// The unit that `units` of `[data.map]` declares for channels of this kind that have none; empty: none is declared.
/// @throws InputError for an unknown unit
[[nodiscard]] std::string declared_unit(const StudyTable& map, const StandardChannel& target);

/// Reads the keys of `[data.map]` where there is no log to apply them to. @throws InputError for an unknown standard
/// name and for values of the wrong kind.
void check_channel_map(const StudyTable& map, std::span<const StandardChannel> standard);

/// The recorded numbers in SI: scale * (raw - zero). Where the log's unit is of another kind than `unit` (volts of a
/// vane, microseconds of a servo) the recorded numbers are scaled and then are in `unit`.
[[nodiscard]] std::vector<double> in_si(const Channel& raw, double zero, double scale, std::string_view unit);

/// Values of `channel` at the stamps of `at`, by linear interpolation; NaN outside.
[[nodiscard]] std::vector<double> interpolated(const Channel& channel, std::span<const double> at);

/// Refuses a recording that lacks a channel that the work needs, in one sentence that names it and what there is
/// instead. `purpose` completes "... is needed for <purpose>".
void require_channels(const MappedRecording& mapped, std::span<const std::string> needed, std::string_view purpose);

}  // namespace veridyn::recording
