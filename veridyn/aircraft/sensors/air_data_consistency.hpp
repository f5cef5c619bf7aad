#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "veridyn/core/recording.hpp"

namespace veridyn::aircraft {

/// A number from a regression, with one standard error.
struct Determined {
  double value = 0.0;
  double sigma = 0.0;
};

/// How a vane reads the flow angle that attitude, ground velocity and the mean wind imply.
struct VaneFit {
  Determined bias;               ///< mean of reading minus angle [rad]
  double largest_reading = 0.0;  ///< 99.9th percentile of the magnitude [rad]
};

/// What ground velocity, heading and attitude say of the air data, in still or steadily moving air.
struct AirDataConsistency {
  std::optional<Determined> airspeed_scale;  ///< reading over true airspeed, found with the wind over the headings
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();  ///< mean, north and east [m/s]
  Eigen::Vector2d wind_sigma = Eigen::Vector2d::Zero();
  std::optional<VaneFit> alpha, beta;
};

/// From `dynamic_pressure`, or else `airspeed` (equivalent where `airspeed_is_true` is false), with the air density
/// given; `roll`, `pitch`, `yaw`, `vel_north|east|down`; `alpha`, `beta` as far as they are there. Half a second is
/// averaged to one row.
///
/// Slow gusts are in the ground velocity too, since the aircraft drifts with them: least squares would be biased. The
/// heading, which the pilot chooses, is the instrument. The wind that the vanes are compared in is averaged over half a
/// minute.
[[nodiscard]] AirDataConsistency air_data_consistency(const Recording& recording, const Channel& air_density,
                                                      bool airspeed_is_true, std::span<const TimeSpan> airborne);

}  // namespace veridyn::aircraft
