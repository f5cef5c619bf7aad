#pragma once

#include <string>
#include <vector>

#include "veridyn/aircraft/sensors/channel_map.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::aircraft {

/// How sensors are brought onto one clock. Study table `[delays]`.
struct DelayAlignment {
  bool automatic = true;      ///< `automatic`: estimate and remove; false: only what the study says
  double max_delay_s = 0.3;   ///< `max`: searched up to here
  double min_delay_s = 0.01;  ///< `min`: smaller ones are left alone
  double band_Hz = 4.0;       ///< `band`: signals are compared below this frequency
  /// Given by the user, by group: `attitude`, `gps`, `airspeed`, `alpha`, `beta`, `elevator`, `aileron`, `rudder` [s].
  std::vector<std::pair<std::string, double>> given;

  /// @throws InputError for values that make no sense.
  [[nodiscard]] static DelayAlignment read(const StudyTable& table);
};

/// How late a group of channels is, against what.
struct DelayReport {
  std::string group;      ///< "attitude"
  std::string reference;  ///< "gyro"
  double delay_s = 0.0;   ///< positive: the group reports late
  double sigma_s = 0.0;
  double correlation = 0.0;
  bool applied = false;
  std::string text;  ///< "applied", or why not
};

/// Estimates how late each sensor is and takes it off its stamps.
///
/// Sensors are compared through kinematics that hold whatever the aerodynamics: attitude rates against the gyro, the
/// derivative of the GPS velocity against rotated specific force and gravity, derivatives of airspeed, alpha and beta
/// against those that rates, specific force and attitude imply in still air (gusts add noise, not delay). Deflections
/// have no such twin: theirs is the delay at which angular acceleration is best explained by rates, flow angles and
/// deflections together.
[[nodiscard]] std::vector<DelayReport> align_delays(MappedRecording& mapped, const DelayAlignment& options);

}  // namespace veridyn::aircraft
