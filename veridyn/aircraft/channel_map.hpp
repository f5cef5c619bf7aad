#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::aircraft {

/// Where one standard channel came from, for the report.
struct ChannelOrigin {
  std::string channel;  ///< standard name, "airspeed"
  std::string source;   ///< "ARSP.Airspeed", "GPS.Spd, GPS.GCrs", "servo 2 (RCOU.C2)"
  double rate_Hz = 0.0;
  std::string note;  ///< what the reader should know: "indicated airspeed", "attitude of the autopilot's filter"
};

/// A recording in standard channel names (SI, frd) and the account of how it was made.
struct MappedRecording {
  Recording recording;
  std::string log_kind;  ///< "ArduPilot", "PX4", "standard names", "study"
  std::vector<ChannelOrigin> origins;
  /// Standard deviation that the calibration of a channel leaves, by channel: an error that all samples share.
  std::vector<std::pair<std::string, double>> calibration_sigma;
  std::vector<std::string> notes;  ///< sensors that are there but dead, estimates that were not taken for sensors, ...
};

/// Full throws of the surfaces [rad], to turn servo positions (-1..1) into deflections; from the subject.
struct SurfaceThrows {
  double elevator = 0.35;
  double aileron = 0.35;
  double rudder = 0.35;
  bool known = false;  ///< false: the values are the default, which the notes then say
};

/// Gives the channels of a log their standard names (the list is in docs/aircraft.md).
///
/// ArduPilot and PX4 logs are recognised by their messages and mapped through the tables in `ardupilot_map.cpp` and
/// `px4_map.cpp`; channels that already bear standard names are kept; keys of `map` (the study's `[data.map]`) come
/// last and win. A key is a standard name, its value the name of a channel or a table:
///
///     airspeed = "ARSP.Airspeed"
///     alpha    = { channel = "CUR2.Volt", zero = 2.5, scale = 0.61, unit = "rad", delay = "20 ms" }
///     aileron  = { channels = ["da_l", "da_r"], weights = [0.5, -0.5], unit = "rad" }
///     elevator = { switch = "mode", cases = { 1 = "de_in", 2 = "de" }, unit = "rad" }
///
/// value = scale * (raw - zero), in `unit` where the log has none; `delay` is how late the sensor reports and is taken
/// off its stamps. `"none"` takes a channel away.
///
/// A source that never changes (an unconnected sensor) is passed over, with a note.
/// @throws InputError for an unknown standard name (nearest suggested) or a source that the log lacks (lists what it
/// has).
[[nodiscard]] MappedRecording map_channels(const Recording& log, const StudyTable& map, const SurfaceThrows& throws);

/// All standard names of aircraft recordings with their SI units.
struct StandardChannel {
  std::string name;
  std::string unit;
};
[[nodiscard]] std::span<const StandardChannel> standard_channels();

/// Refuses a recording that lacks a channel that the work needs, in one sentence that names it and what there is
/// instead. `purpose` completes "... is needed for <purpose>".
void require_channels(const MappedRecording& mapped, std::span<const std::string> needed, std::string_view purpose);

}  // namespace veridyn::aircraft
