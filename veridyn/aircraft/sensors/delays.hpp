#pragma once

#include <vector>

#include "veridyn/aircraft/model/atmosphere.hpp"
#include "veridyn/aircraft/sensors/channel_map.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/numerics/rotation.hpp"
#include "veridyn/recording/delays.hpp"

namespace veridyn::aircraft {

using recording::DelayReport;

/// How sensors are brought onto one clock, in groups: attitude, GPS, airspeed, each vane, each surface. Study table
/// `[delays]`.
struct DelayAlignment : recording::DelayOptions {
  // What the motion past the vanes is computed with; no keys of this table.
  double air_density = kSeaLevelDensity;                   ///< median of the flight [kg/m^3]
  bool airspeed_is_true = true;                            ///< a channel `airspeed`; false: equivalent
  numerics::Vector3<double> vane_position{0.0, 0.0, 0.0};  ///< from the centre of gravity, body axes [m]

  [[nodiscard]] static const KeyTable<DelayAlignment>& keys();
};

/// A recording whose sensors are on one clock, and how late each was.
struct AlignedRecording {
  MappedRecording mapped;
  std::vector<DelayReport> delays;
};

/// Estimates how late each sensor is and takes it off its stamps.
///
/// Sensors are compared through kinematics that hold whatever the aerodynamics: attitude rates against the gyro, the
/// derivative of the GPS velocity against rotated specific force and gravity, the derivative of the airspeed against
/// the one that specific force and attitude imply in still air. A vane is compared twice: with lift or side force, and
/// with the angle that rates, specific force and attitude imply in still air. The first needs gusts, which show in vane
/// and force at once; the second needs air without them, as the aircraft answers a gust late: its error grows with the
/// share of the vane's motion that is neither motion of the aircraft nor noise. What has the smaller error is taken.
/// Deflections have no such twin: theirs is the delay at which angular acceleration is best explained by rates, flow
/// angles and deflections together. Deflections that move together (recording::kMoveTogether: a mix of the autopilot,
/// the pair of a V-tail) are given one delay, since they have no single ones that a recording shows.
///
/// A sensor slower than recording::kSlowestDelayed_Hz is left alone, with a note in its report. Stops after the group
/// at hand when `progress` is interrupted: groups without a report are then as they were.
[[nodiscard]] AlignedRecording align_delays(MappedRecording mapped, const DelayAlignment& options, Progress& progress);

/// The same without progress.
[[nodiscard]] AlignedRecording align_delays(MappedRecording mapped, const DelayAlignment& options);

}  // namespace veridyn::aircraft
