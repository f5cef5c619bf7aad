#pragma once

#include <cmath>

#include "veridyn/muscle/actuator/activation_dynamics.hpp"
#include "veridyn/muscle/model/muscle_parameters.hpp"
#include "veridyn/muscle/model/scalar.hpp"

namespace veridyn::muscle {

/// Thelen's curves as OpenSim up to version 2 computed them (`Thelen2003Muscle_Deprecated`); many published results are
/// this form. Members and units as in `Thelen2003`; the differences:
/// - velocities are in units of (Vmax0 + a (Vmax - Vmax0)) L0, and their denominator carries a damping;
/// - the tendon's toe ends at force 1/3 and strain 0.609 e0, its slope is 1.712/e0 and 0.001 length/LS is added at all
///   lengths, so that it pulls when slack as well;
/// - passive force exp(k (l - 1)/e0M - k) acts below l = 1 too (0.018 there) and continues straight above 1 + e0M;
/// - the time constants of activation do not depend on activation.
class Thelen2003Deprecated {
 public:
  explicit Thelen2003Deprecated(const DeprecatedThelenCurves& c = {})
      : inverse_width_(1.0 / c.active_width),
        passive_rate_(c.passive_exponent / c.passive_strain),
        passive_exponent_(c.passive_exponent),
        passive_end_(1.0 + c.passive_strain),
        inverse_Af_(1.0 / c.Af),
        Flen_(c.Flen),
        damping_(c.damping),
        Vmax0_(c.Vmax0),
        lengthening_((2.0 + 2.0 / c.Af) / (c.Flen - 1.0)),
        toe_strain_(0.609 * c.tendon_strain),
        toe_scale_(kToeForce / (std::exp(3.0) - 1.0)),
        toe_rate_(3.0 / toe_strain_),
        tendon_slope_(1.712 / c.tendon_strain) {}

  static constexpr double kMinLength = 0.01;

  [[nodiscard]] double toe_strain() const { return toe_strain_; }

  template <typename Scalar>
  [[nodiscard]] Scalar tendon_force(const Scalar& length) const {
    using std::exp;
    const Scalar strain = length - Scalar(1.0);
    Scalar base = Scalar(kTendonBase) * length;
    if (strain <= Scalar(0.0)) return base;
    if (strain > Scalar(toe_strain_))
      return base + Scalar(tendon_slope_) * (strain - Scalar(toe_strain_)) + Scalar(kToeForce);
    return base + Scalar(toe_scale_) * (exp(Scalar(toe_rate_) * strain) - Scalar(1.0));
  }
  [[nodiscard]] CurveValue tendon(double length) const {
    const double strain = length - 1.0;
    double slope = 0.0;
    if (strain > toe_strain_)
      slope = tendon_slope_;
    else if (strain > 0.0)
      slope = toe_scale_ * toe_rate_ * std::exp(toe_rate_ * strain);
    return {tendon_force(length), slope + kTendonBase};
  }
  [[nodiscard]] double tendon_energy(double length) const {
    const double strain = length - 1.0;
    const double base = 0.5 * kTendonBase * (length * length - 1.0);
    if (strain <= 0.0) return base;
    const auto toe = [&](double e) { return toe_scale_ * (std::expm1(toe_rate_ * e) / toe_rate_ - e); };
    if (strain <= toe_strain_) return base + toe(strain);
    const double beyond = strain - toe_strain_;
    return base + toe(toe_strain_) + beyond * (kToeForce + 0.5 * tendon_slope_ * beyond);
  }

  template <typename Scalar>
  [[nodiscard]] Scalar active_length(const Scalar& l) const {
    using std::exp;
    const Scalar x = l - Scalar(1.0);
    return exp(x * x * Scalar(-inverse_width_));
  }
  [[nodiscard]] CurveValue active(double l) const {
    const double f = active_length(l);
    return {f, -2.0 * (l - 1.0) * inverse_width_ * f};
  }

  template <typename Scalar>
  [[nodiscard]] Scalar passive_force(const Scalar& l) const {
    using std::exp;
    if (l > Scalar(passive_end_)) return Scalar(1.0) + Scalar(passive_rate_) * (l - Scalar(passive_end_));
    return exp(Scalar(passive_rate_) * (l - Scalar(1.0)) - Scalar(passive_exponent_));
  }
  [[nodiscard]] CurveValue passive(double l) const {
    const double f = passive_force(l);
    return {f, passive_rate_ * (l > passive_end_ ? 1.0 : f)};
  }
  /// From l = 0 [F0 L0].
  [[nodiscard]] double passive_energy(double l) const {
    const auto below = [&](double x) { return (passive_force(x) - passive_force(0.0)) / passive_rate_; };
    if (l <= passive_end_) return below(l);
    const double beyond = l - passive_end_;
    return below(passive_end_) + beyond * (1.0 + 0.5 * passive_rate_ * beyond);
  }

  template <typename Scalar>
  [[nodiscard]] Scalar velocity_unit(const Scalar& a, const Scalar& Vmax) const {
    return Scalar(Vmax0_) + a * (Vmax - Scalar(Vmax0_));
  }

  template <typename Scalar>
  [[nodiscard]] Scalar velocity(const Scalar& a, const Scalar& fL, const Scalar& F, double /*damping*/) const {
    const Scalar A = a * fL, d(damping_);
    const Scalar end = Scalar(kThreshold * Flen_) * A;
    if (F < Scalar(0.0)) {
      const Scalar b = A + d;
      return (F - A) / b + A * Scalar(inverse_Af_) * F / (b * b);
    }
    if (F <= A) return (F - A) / (A + F * Scalar(inverse_Af_) + d);
    if (F < end) return (F - A) / (Scalar(lengthening_) * (A * Scalar(Flen_) - F) + d);
    const Scalar b = Scalar(lengthening_ * (1.0 - kThreshold) * Flen_) * A + d;
    return (F - A) / b + (end - A) * Scalar(lengthening_) * (F - end) / (b * b);
  }

  template <typename Scalar>
  [[nodiscard]] Scalar active_force(const Scalar& a, const Scalar& fL, const Scalar& v) const {
    const Scalar A = a * fL, d(damping_);
    const Scalar end = Scalar(kThreshold * Flen_) * A;
    const Scalar low = A + d;
    if (v * low < -A) return (v * low + A) / (Scalar(1.0) + A * Scalar(inverse_Af_) / low);
    if (v <= Scalar(0.0)) return (A + v * low) / (Scalar(1.0) - v * Scalar(inverse_Af_));
    const Scalar high = Scalar(lengthening_ * (1.0 - kThreshold) * Flen_) * A + d;
    const Scalar beyond = v * high - (end - A);
    if (beyond > Scalar(0.0)) return end + beyond / (Scalar(1.0) + (end - A) * Scalar(lengthening_) / high);
    return (A + v * (Scalar(lengthening_ * Flen_) * A + d)) / (Scalar(1.0) + v * Scalar(lengthening_));
  }

  template <typename Scalar>
  [[nodiscard]] Scalar activation_rate(const Scalar& u, const Scalar& a, const Scalar& activation_time,
                                       const Scalar& deactivation_time) const {
    return constant_activation_rate(u, a, activation_time, deactivation_time);
  }

 private:
  static constexpr double kToeForce = 1.0 / 3.0;
  static constexpr double kTendonBase = 0.001;
  static constexpr double kThreshold = 0.95;

  double inverse_width_, passive_rate_, passive_exponent_, passive_end_, inverse_Af_, Flen_, damping_, Vmax0_;
  double lengthening_, toe_strain_, toe_scale_, toe_rate_, tendon_slope_;
};

}  // namespace veridyn::muscle
