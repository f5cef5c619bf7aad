#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include "veridyn/muscle/actuator/activation_dynamics.hpp"
#include "veridyn/muscle/actuator/damped_velocity.hpp"
#include "veridyn/muscle/actuator/quintic_bezier_curve.hpp"
#include "veridyn/muscle/model/muscle_parameters.hpp"
#include "veridyn/muscle/model/scalar.hpp"

namespace veridyn::muscle {

/// Curves of Millard, Uchida, Seth & Delp (2013), J. Biomech. Eng. 135:021005, as OpenSim's
/// Millard2012EquilibriumMuscle has them: quintic Bezier chains, twice continuously differentiable. Units as in
/// `Thelen2003`.
///
/// `damped` (fibre damping >= 0.001 or a rigid tendon): the active curve falls to 0 at both ends, the force-velocity
/// curve ends level, and `velocity` solves A fV(v) + damping v = F. Undamped: the active curve does not fall below
/// `minimum_value`, and velocity comes from an inverse curve with end slopes of half the slopes near Vmax.
///
/// A copy shares the tables (about 50 kB).
class Millard2012 {
 public:
  /// @throws InputError when the shape parameters contradict each other.
  explicit Millard2012(const MillardCurves& curves = {}, bool damped = true);

  static constexpr double kDampingThreshold = 0.001;  ///< fibre damping below it counts as none
  static constexpr double kLeastActive = 1e-9;        ///< a fL is taken as at least this when undamped

  [[nodiscard]] bool damped() const { return damped_; }
  [[nodiscard]] double min_length() const { return curves_->active.begin(); }
  [[nodiscard]] const QuinticBezierCurve& active_curve() const { return curves_->active; }
  [[nodiscard]] const QuinticBezierCurve& passive_curve() const { return curves_->passive; }
  [[nodiscard]] const QuinticBezierCurve& tendon_curve() const { return curves_->tendon; }
  [[nodiscard]] const QuinticBezierCurve& velocity_curve() const { return curves_->velocity; }
  [[nodiscard]] const QuinticBezierCurve& inverse_velocity_curve() const { return curves_->inverse_velocity; }

  template <typename Scalar>
  [[nodiscard]] Scalar tendon_force(const Scalar& length) const {
    return curves_->tendon.value(length);
  }
  [[nodiscard]] CurveValue tendon(double length) const { return curves_->tendon.value_and_slope(length); }
  [[nodiscard]] double tendon_energy(double length) const { return curves_->tendon.integral(length); }

  template <typename Scalar>
  [[nodiscard]] Scalar active_length(const Scalar& l) const {
    return curves_->active.value(l);
  }
  [[nodiscard]] CurveValue active(double l) const { return curves_->active.value_and_slope(l); }

  template <typename Scalar>
  [[nodiscard]] Scalar passive_force(const Scalar& l) const {
    return curves_->passive.value(l);
  }
  [[nodiscard]] CurveValue passive(double l) const { return curves_->passive.value_and_slope(l); }
  [[nodiscard]] double passive_energy(double l) const { return curves_->passive.integral(l); }

  template <typename Scalar>
  [[nodiscard]] Scalar velocity_unit(const Scalar& /*a*/, const Scalar& Vmax) const {
    return Vmax;
  }

  /// fV with slope and curvature, from its table.
  [[nodiscard]] auto quick_velocity_curve() const {
    return [this](double v) { return curves_->velocity.tabulated_with_curvature(v); };
  }

  template <typename Scalar>
  [[nodiscard]] Scalar velocity(const Scalar& a, const Scalar& fL, const Scalar& F, double damping) const {
    Scalar A = a * fL;
    if (!damped_) {
      if (A < Scalar(kLeastActive)) A = Scalar(kLeastActive);
      return curves_->inverse_velocity.value(F / A);
    }
    return damped_velocity(A, F, damped_balance(value_of(A), value_of(F), damping), quick_velocity_curve());
  }

  /// The damped balance A fV(v) + damping v = F, ready to be iterated with `quick_velocity_curve`.
  [[nodiscard]] DampedVelocity damped_balance(double A, double F, double damping) const {
    // fV lies between 0 and its greatest value, so damping v between F - A fmax and F.
    const double per = 1.0 / damping;
    double low = (F - A * curves_->velocity.value_at_end()) * per, high = F * per;
    if (F < A)
      high = std::max(low, std::min(high, 0.0));
    else
      low = std::min(high, std::max(low, 0.0));
    return {A, F, damping, low, high, start(A, F, damping, low, high)};
  }

  template <typename Scalar>
  [[nodiscard]] Scalar active_force(const Scalar& a, const Scalar& fL, const Scalar& v) const {
    return a * fL * curves_->velocity.value(v);
  }

  template <typename Scalar>
  [[nodiscard]] Scalar activation_rate(const Scalar& u, const Scalar& a, const Scalar& activation_time,
                                       const Scalar& deactivation_time) const {
    return muscle::activation_rate(u, a, activation_time, deactivation_time);
  }

 private:
  struct Curves {
    QuinticBezierCurve active, passive, tendon, velocity, inverse_velocity;
  };

  /// Where Newton's method begins: the balance with a hyperbola of the same end, value and slope at rest in place of
  /// the curve, (1 + v)/(1 - (slope - 1) v) while shortening, 1 + v d/(v + d/slope) with d = fmax - 1 while
  /// lengthening: a quadratic equation.
  [[nodiscard]] double start(double A, double F, double damping, double low, double high) const {
    if (F < A) {
      // damping m v^2 - (damping + A + F m) v - (A - F) = 0 with m = slope - 1; the root below zero
      const double m = isometric_slope_ - 1.0;
      const double half = 0.5 * (damping + A + F * m);
      const double v = -(A - F) / (half + std::sqrt(std::max(0.0, half * half + damping * m * (A - F))));
      return v > low && v <= high ? std::max(v, low) : 0.5 * (low + high);
    }
    // damping v^2 + (damping e + A (1 + d) - F) v - (F - A) e = 0 with e = d/slope; the root above zero
    const double d = curves_->velocity.value_at_end() - 1.0, e = d / isometric_slope_;
    const double half = 0.5 * (damping * e + A * (1.0 + d) - F), c = damping * (F - A) * e;
    const double root = std::sqrt(half * half + c);
    const double v = half > 0.0 ? (F - A) * e / (half + root) : (root - half) / damping;
    return v >= low && v <= high ? v : 0.5 * (low + high);
  }

  std::shared_ptr<const Curves> curves_;
  double isometric_slope_;
  bool damped_;
};

}  // namespace veridyn::muscle
