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

/// How a vane answers fast changes of the flow angle that gyro and accelerometer see.
struct VaneSlope {
  Determined slope;        ///< reading over angle
  double relevance = 0.0;  ///< share of the angle's fast changes that the controls make
};

/// Change of `alpha` over a quarter of a second against its integral from gyro, accelerometer and attitude,
///     alpha' = q - p tan(beta) + (a_z cos(alpha) - a_x sin(alpha) + g (cos(theta) cos(phi) cos(alpha)
///              + sin(theta) sin(alpha))) / V_a,
/// which sees the aircraft move and not the gust, while the vane sees both. The aircraft answers gusts, so that the two
/// are correlated: the change of the elevator is the instrument, and `manoeuvres` are stretches in which the pilot, not
/// the gust, moves it. Nothing where a channel is missing or the controls move the angle by less than 2 % of its
/// changes.
[[nodiscard]] std::optional<VaneSlope> alpha_slope(const Recording& recording, const Channel& air_density,
                                                   bool airspeed_is_true, std::span<const TimeSpan> manoeuvres);
/// The same of `beta`, beta' = p sin(alpha) - r cos(alpha) + (a_y + g cos(theta) sin(phi)) / V_a, moved by rudder and
/// aileron.
[[nodiscard]] std::optional<VaneSlope> beta_slope(const Recording& recording, const Channel& air_density,
                                                  bool airspeed_is_true, std::span<const TimeSpan> manoeuvres);

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
