#pragma once

#include <limits>
#include <numbers>

namespace veridyn {

/// The ratio of a circle's circumference to its diameter.
inline constexpr double kPi = std::numbers::pi;
/// A full turn [rad].
inline constexpr double kFullTurn = 2.0 * std::numbers::pi;
/// Standard gravity [m/s^2].
inline constexpr double kGravity = 9.80665;
/// One degree [rad].
inline constexpr double kDegree = std::numbers::pi / 180.0;
/// What is not known.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
/// Without a bound.
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace veridyn
