#pragma once

#include <cmath>

#include "veridyn/muscle/piecewise_polynomial.hpp"
#include "veridyn/muscle/scalar.hpp"

namespace veridyn::muscle {

/// The velocity v at which active force and damping balance: A fV(v) + damping v = F, for an increasing curve fV and
/// damping > 0 (Millard et al. 2013, section on the damped equilibrium).
///
/// Halley's method from `start`, kept inside [low, high], which must hold the root; a step that would leave it is
/// replaced by halving. It always ends: at most 100 evaluations, two as a rule. With dual numbers the solution carries
/// the derivatives of the implicit function. `curve(v)` returns the FunctionValue of fV.
template <typename Scalar, typename Curve>
[[nodiscard]] Scalar damped_velocity(const Scalar& A_in, double damping, const Scalar& F_in, double low, double high,
                                     double start, const Curve& curve) {
  const double A = value_of(A_in), F = value_of(F_in);
  double v = start;
  for (int i = 0; i < 100; ++i) {
    const FunctionValue<double> f = curve(v);
    const double residual = A * f.value + damping * v - F, slope = A * f.slope + damping;
    if (residual > 0.0)
      high = v;
    else
      low = v;
    const double bend = slope * slope - 0.5 * residual * A * f.curvature;
    const double step = bend > 0.0 ? residual * slope / bend : residual / slope;
    // The error is of the order of the cube of the step, times some tens for the bend of these curves at rest.
    if (std::abs(step) < 1e-5) {
      v -= step;
      break;
    }
    const double next = v - step;
    v = next > low && next < high ? next : 0.5 * (low + high);
    if (!(low < high)) break;
  }
  if constexpr (DualNumber<Scalar>) {
    const FunctionValue<double> f = curve(v);
    const double slope = A * f.slope + damping;
    const Scalar residual = A_in * Scalar(f.value) + Scalar(damping * v) - F_in;
    return Scalar(v) - residual * Scalar(1.0 / slope);
  } else {
    return v;
  }
}

}  // namespace veridyn::muscle
