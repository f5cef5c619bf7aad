#pragma once

#include <array>

#include "veridyn/aircraft/simulation/dryden.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {

/// Standard deviation of p_g, below [rad/s].
/// @param span b [m]
[[nodiscard]] double gust_roll_sigma(const DrydenSettings& settings, double span);
/// Distance over which it correlates with itself, 4b/pi [m].
[[nodiscard]] double gust_roll_length(double span);

/// Gradients of Dryden gusts over the aircraft, as rates that act like additional body rates in the aerodynamics
/// (MIL-F-8785C; b is the span, s along the path):
///
///     q_g =  dw_g/dx = s/(1 + (4b/pi) s) w_g
///     r_g = -dv_g/dx = -s/(1 + (3b/pi) s) v_g
///     p_g = -dw_g/dy, independent, of spectrum (sigma_w^2/L_w) 0.8 (pi L_w/4b)^(1/3)/(1 + (4b W/pi)^2), W >= 0 [rad/m]
///
/// A pitch rate q gives a point ahead of the centre of gravity by x the velocity -q x along z, as a gust that grows by
/// dw_g/dx does: what the wing and tail meet is (p + p_g, q + q_g, r + r_g).
class GustGradients {
 public:
  /// Begins with p_g stationary and without q_g and r_g, which are stationary after some spans.
  /// @param span b [m]
  GustGradients(const DrydenSettings& settings, double span, numerics::RandomStream random);

  /// Goes on by `step` [s] at airspeed `Va` [m/s], in which gusts change linearly from `before` to `after` [m/s].
  void advance(double step, double Va, const std::array<double, 3>& before, const std::array<double, 3>& after);
  /// [p_g, q_g, r_g] [rad/s].
  [[nodiscard]] std::array<double, 3> rates() const;

 private:
  double roll_length_, yaw_length_;  ///< 4b/pi, 3b/pi [m]
  double roll_sigma_;                ///< standard deviation of p_g [rad/s]
  numerics::RandomStream random_;
  double p_ = 0.0;            ///< in units of its standard deviation
  double v_ = 0.0, w_ = 0.0;  ///< gusts less what the filters have of them [m/s]
};

}  // namespace veridyn::aircraft
