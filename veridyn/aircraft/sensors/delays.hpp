#pragma once

#include <vector>

#include "veridyn/aircraft/sensors/channel_map.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/recording/delays.hpp"

namespace veridyn::aircraft {

using recording::DelayReport;

/// How sensors are brought onto one clock: the keys of recording::DelayOptions, with the groups `attitude`, `gps`,
/// `airspeed`, `alpha`, `beta`, `elevator`, `aileron`, `rudder`. Study table `[delays]`.
struct DelayAlignment : recording::DelayOptions {
  /// @throws InputError for values that make no sense.
  [[nodiscard]] static DelayAlignment read(const StudyTable& table);
};

/// A recording whose sensors are on one clock, and how late each was.
struct AlignedRecording {
  MappedRecording mapped;
  std::vector<DelayReport> delays;
};

/// Estimates how late each sensor is and takes it off its stamps.
///
/// Sensors are compared through kinematics that hold whatever the aerodynamics: attitude rates against the gyro, the
/// derivative of the GPS velocity against rotated specific force and gravity, derivatives of airspeed, alpha and beta
/// against those that rates, specific force and attitude imply in still air (gusts add noise, not delay). Deflections
/// have no such twin: theirs is the delay at which angular acceleration is best explained by rates, flow angles and
/// deflections together. Deflections that move together (recording::kMoveTogether: a mix of the autopilot, the pair of
/// a V-tail) are given one delay, since they have no single ones that a recording shows.
///
/// A sensor slower than recording::kSlowestDelayed_Hz is left alone, with a note in its report. Stops after the group
/// at hand when `progress` is interrupted: groups without a report are then as they were.
[[nodiscard]] AlignedRecording align_delays(MappedRecording mapped, const DelayAlignment& options, Progress& progress);

/// The same without progress.
[[nodiscard]] AlignedRecording align_delays(MappedRecording mapped, const DelayAlignment& options);

}  // namespace veridyn::aircraft
