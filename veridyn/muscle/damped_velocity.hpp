#pragma once

#include <cmath>

#include "veridyn/muscle/scalar.hpp"

namespace veridyn::muscle {

/// The velocity v at which active force and damping balance: A fV(v) + damping v = F, for an increasing curve fV and
/// damping > 0 (Millard et al. 2013, section on the damped equilibrium).
///
/// Newton's method from `start`, kept inside [low, high], which must hold the root; where a step would leave it, it is
/// halved. It always ends: at most 100 evaluations, three as a rule. With dual numbers the solution carries the
/// derivatives of the implicit function. `curve(v)` returns the CurveValue of fV.
template <typename Scalar, typename Curve>
[[nodiscard]] Scalar damped_velocity(const Scalar& A_in, double damping, const Scalar& F_in, double low, double high,
                                     double start, const Curve& curve) {
  const double A = value_of(A_in), F = value_of(F_in);
  double v = start;
  CurveValue f{};
  double slope = damping;
  for (int i = 0; i < 100; ++i) {
    f = curve(v);
    const double residual = A * f.value + damping * v - F;
    slope = A * f.slope + damping;
    if (residual > 0.0)
      high = v;
    else
      low = v;
    double next = v - residual / slope;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const double step = std::abs(next - v);
    v = next;
    // Newton's error is the square of its step; what remains is the rounding of F.
    if (step <= 1e-9 * (1.0 + std::abs(v)) || !(low < high)) break;
  }
  if constexpr (DualNumber<Scalar>) {
    f = curve(v);
    slope = A * f.slope + damping;
    const Scalar residual = A_in * Scalar(f.value) + Scalar(damping * v) - F_in;
    return Scalar(v) - residual * Scalar(1.0 / slope);
  } else {
    return v;
  }
}

}  // namespace veridyn::muscle
