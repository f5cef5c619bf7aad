#pragma once

#include <Eigen/LU>
#include <cmath>

#include "veridyn/vehicle/model/bicycle_analysis.hpp"

namespace veridyn::vehicle::testing {

/// Exact motion of the linear bicycle after a step of steer from straight running, at `time` after the step.
struct BicycleStepResponse {
  double v = 0.0, r = 0.0, lateral_acceleration = 0.0;
};
/// After a step of `steer` [rad], at `time` [s].
inline BicycleStepResponse step_response(const LinearBicycle<double>& bicycle, double steer, double time) {
  if (!(time >= 0.0)) return {};
  const Eigen::Matrix2d A = bicycle.A();
  const Eigen::Vector2d drive = bicycle.B() * steer;
  // x = integral of exp(A t) B: with M = A - s I, s half the trace, M^2 = d I, so exp(A t) = e^(s t) (cosh I + sinh/w
  // M) for w = sqrt(d), cos and sin for negative d.
  const double s = 0.5 * A.trace();
  const Eigen::Matrix2d M = A - s * Eigen::Matrix2d::Identity();
  const double d = -M.determinant();
  const double w = std::sqrt(std::abs(d));
  const double wt = w * time;
  const double even = d > 0.0 ? std::cosh(wt) : std::cos(wt);
  const double odd = wt < 1e-8 ? time : (d > 0.0 ? std::sinh(wt) : std::sin(wt)) / w;
  const Eigen::Matrix2d exponential = std::exp(s * time) * (even * Eigen::Matrix2d::Identity() + odd * M);
  const Eigen::Vector2d x = A.fullPivLu().solve((exponential - Eigen::Matrix2d::Identity()) * drive);
  const Eigen::Vector3d y = bicycle.C() * x + bicycle.D() * steer;
  return {x(0), x(1), y(1)};
}

}  // namespace veridyn::vehicle::testing
