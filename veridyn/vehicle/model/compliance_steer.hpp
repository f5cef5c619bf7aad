#pragma once

#include <type_traits>

#include "veridyn/vehicle/tyre/wheel_arrays.hpp"

namespace veridyn::vehicle {

/// How far wheels give way to the lateral forces of their tyres: the steer x of each with
///
///     x = c F_y(x)
///
/// where the force itself depends on x through the slip angle. `force_at(x, Fy)` gives the forces at a steer; it is
/// called last at the result. A secant method for all wheels together; `gain` is c dF_y/dx where the first step starts
/// from, at most 0.9. To 1e-13 rad, mostly in three or four calls; derivatives of Jets to 1e-9 of themselves. Does not
/// allocate.
template <typename Scalar, typename ForceAt>
[[nodiscard]] WheelArray<Scalar> compliance_steer(const WheelArray<Scalar>& compliance, const WheelArray<Scalar>& gain,
                                                  const ForceAt& force_at) {
  using Wheels = WheelArray<Scalar>;
  constexpr int kMostCalls = 16;
  constexpr double kClose = 1e-13, kUsefulStep = 1e-7, kLeastSlope = 0.1;
  Wheels steer = Wheels::Constant(Scalar(0.0)), force, before;
  // Of the residual c F - x, downward; 1 where the force does not change.
  Wheels slope = Scalar(1.0) - gain;
  force_at(steer, force);
  for (int call = 1; call < kMostCalls; ++call) {
    const Wheels residual = compliance * force - steer;
    if constexpr (std::is_floating_point_v<Scalar>) {
      if (residual.abs().maxCoeff() < kClose) break;
    }
    const Wheels step = residual / slope;
    steer += step;
    before = force;
    force_at(steer, force);
    for (Eigen::Index i = 0; i < 4; ++i) {
      // A shorter step shows more of rounding than of the slope.
      if (!(step[i] > kUsefulStep || step[i] < -kUsefulStep)) continue;
      slope[i] = 1.0 - compliance[i] * (force[i] - before[i]) / step[i];
      if (slope[i] < kLeastSlope) slope[i] = Scalar(kLeastSlope);
    }
  }
  return steer;
}

}  // namespace veridyn::vehicle
