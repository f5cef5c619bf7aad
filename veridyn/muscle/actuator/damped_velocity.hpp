#pragma once

#include <cmath>

#include "veridyn/muscle/model/scalar.hpp"
#include "veridyn/numerics/piecewise_polynomial.hpp"

namespace veridyn::muscle {

/// The velocity v at which active force and damping balance, A fV(v) + damping v = F, for an increasing curve fV and
/// damping > 0 (Millard et al. 2013, section on the damped equilibrium), by Halley's method.
///
/// It is kept inside [low, high], which must hold the root: a step that would leave it is replaced by halving.
struct DampedVelocity {
  double A, F, damping, low, high;
  double v;           ///< the estimate so far; a guess at first
  bool done = false;  ///< the next step would be below rounding

  /// `curve(v)` returns the numerics::FunctionValue of fV.
  template <typename Curve>
  void iterate(const Curve& curve) {
    const numerics::FunctionValue<double> f = curve(v);
    const double residual = A * f.value + damping * v - F, slope = A * f.slope + damping;
    low = residual > 0.0 ? low : v;
    high = residual > 0.0 ? v : high;
    const double bend = slope * slope - 0.5 * residual * A * f.curvature;
    const double step = bend > 0.0 ? residual * slope / bend : residual / slope;
    const double next = v - step;
    // The error is of the order of the cube of the step, times some tens for the bend of these curves at rest.
    const bool small = std::abs(step) < 1e-5;
    v = small || (next > low && next < high) ? next : 0.5 * (low + high);
    done = small || !(low < high);
  }
  /// To the end: at most 100 evaluations, two or three as a rule.
  template <typename Curve>
  void finish(const Curve& curve) {
    for (int i = 0; i < 100 && !done; ++i) iterate(curve);
  }
};

/// The solution found for the values of A and F with the derivatives of the implicit function.
template <typename Scalar, typename Curve>
[[nodiscard]] Scalar damped_velocity(const Scalar& A, const Scalar& F, DampedVelocity begin, const Curve& curve) {
  begin.finish(curve);
  if constexpr (DualNumber<Scalar>) {
    const numerics::FunctionValue<double> f = curve(begin.v);
    const Scalar residual = A * Scalar(f.value) + Scalar(begin.damping * begin.v) - F;
    return Scalar(begin.v) - residual * Scalar(1.0 / (begin.A * f.slope + begin.damping));
  } else {
    return begin.v;
  }
}

}  // namespace veridyn::muscle
