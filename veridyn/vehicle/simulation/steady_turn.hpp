#pragma once

#include <span>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/manoeuvre/manoeuvre.hpp"
#include "veridyn/vehicle/model/vehicle_trajectory.hpp"

namespace veridyn::vehicle {

/// Where ISO 4138 reads gradients: from hardly turning [m/s^2],
inline constexpr double kGentlestTurn = 0.5;
/// to where tyres begin to saturate [m/s^2].
inline constexpr double kSharpestGentleTurn = 4.0;

/// What a drive that turns steadily, or slowly more and more, shows sample by sample, as if it turned to the left.
struct TurnSamples {
  std::vector<double> acceleration;  ///< centripetal, speed times yaw rate; >= 0 [m/s^2]
  std::vector<double> extra_steer;   ///< beyond L/R [rad]
  std::vector<double> sideslip;      ///< at the centre of gravity [rad]
  std::vector<double> roll;          ///< to the outside of the turn [rad]; empty: the model has none
};
/// From the time `begin` [s] on.
[[nodiscard]] TurnSamples steady_turn(const VehicleTrajectory& trajectory, double wheelbase, double begin = 0.0);

/// From when on a manoeuvre turns steadily or slowly more [s]; infinite: never. On a given circle its beginning is the
/// driver's way onto it.
[[nodiscard]] double steady_turn_begin(const Manoeuvre& manoeuvre);

/// A straight line through what a turn shows over its acceleration.
struct TurnGradient {
  double slope = kNaN;      ///< [rad/(m/s^2)]; NaN where fewer than three samples are in the range, or all are alike
  double intercept = kNaN;  ///< [rad]
};
/// By least squares over the samples with an acceleration from `low` to `high` [m/s^2]. Sizes equal.
[[nodiscard]] TurnGradient turn_gradient(std::span<const double> acceleration, std::span<const double> shown,
                                         double low = kGentlestTurn, double high = kSharpestGentleTurn);

}  // namespace veridyn::vehicle
