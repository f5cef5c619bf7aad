#pragma once

#include <string>
#include <vector>

#include "veridyn/cueing/platform/platform_limits.hpp"

namespace veridyn::cueing {

/// What an experiment shows over time.
struct Experiment {
  std::vector<double> time;  ///< [s]
  /// One line of it.
  struct Curve {
    std::string name;
    std::vector<double> values;  ///< [rad]
  };
  std::vector<Curve> curves;
};

/// The scaled car over a ramp of 30 deg up and down again (or banked by as much): the commands of the platform with
/// washout, and without: there the angle that was turned through and the tilt for the force add up. Before the
/// platform's limits. Curves "road", "with washout", "without washout".
/// @param axis kPitch or kRoll
[[nodiscard]] Experiment ramp(PlatformAxis axis);

/// The scaled car (one fifth) that accelerates and brakes on a level track: the pitch that the accelerometer alone
/// shows, and what is left of it when a camera's acceleration is taken off first. The camera sees 250 pixels a metre,
/// 50 times a second, and takes its acceleration from a parabola through 0.3 s. Curves "naive", "with the camera".
[[nodiscard]] Experiment level_track();

/// Where the measured three-axis platform comes to rest. @param axis kRoll or kPitch @param ordered [rad]
[[nodiscard]] double reached(PlatformAxis axis, double ordered);

/// Tilt of that platform under a lasting force by tilt coordination alone [rad]. @param force [m/s^2]
[[nodiscard]] double held_tilt(PlatformAxis axis, double force);

}  // namespace veridyn::cueing
