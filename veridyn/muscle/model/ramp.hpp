#pragma once

#include <span>

#include "veridyn/numerics/piecewise_polynomial.hpp"

namespace veridyn::muscle {

/// How a coordinate goes from one value to another; s = (t - start)/duration from 0 to 1.
enum class RampShape {
  kMinimumJerk,  ///< 10 s^3 - 15 s^4 + 6 s^5 (Flash & Hogan 1985): speed and acceleration begin and end at zero
  kHalfSine,     ///< (1 - cos pi s)/2: the acceleration jumps at both ends
  kLinear,       ///< s: the speed jumps at both ends
};

/// A desired movement of one coordinate: `from` before `start`, `to` after `start + duration`.
struct Ramp {
  double start = 0.0;     ///< [s]
  double duration = 1.0;  ///< [s], > 0
  double from = 0.0;      ///< [rad] or [m]
  double to = 0.0;
  RampShape shape = RampShape::kMinimumJerk;
};

/// Ramps of one coordinate, in order of time, each beginning after the end of the one before and at its `to`.
/// Piecewise quintic: minimum jerk and linear ramps exactly, half sines to 1e-11 of their rise.
[[nodiscard]] numerics::PiecewisePolynomial ramp_spline(std::span<const Ramp> ramps);

/// A coordinate that stays where it is.
[[nodiscard]] numerics::PiecewisePolynomial resting_spline(double value);

}  // namespace veridyn::muscle
