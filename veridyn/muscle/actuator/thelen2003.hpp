#pragma once

#include <cmath>

#include "veridyn/muscle/actuator/activation_dynamics.hpp"
#include "veridyn/muscle/model/muscle_parameters.hpp"
#include "veridyn/muscle/model/scalar.hpp"

namespace veridyn::muscle {

/// Curves of Thelen (2003), J. Biomech. Eng. 125:70, as OpenSim's Thelen2003Muscle has them.
///
/// Dimensionless: forces in F0, fibre lengths in L0, tendon lengths in LS, velocities in Vmax L0 (positive while the
/// fibre lengthens). Slopes jump at slack length, at l = 1 (passive) and at v = 0 (doubled on lengthening). Functions
/// do not throw or allocate. `velocity` is explicit: the force-velocity relation of this model is solved for velocity.
class Thelen2003 {
 public:
  explicit Thelen2003(const ThelenCurves& c = {})
      : inverse_width_(1.0 / c.active_width),
        passive_rate_(c.passive_exponent / c.passive_strain),
        passive_scale_(1.0 / (std::exp(c.passive_exponent) - 1.0)),
        inverse_Af_(1.0 / c.Af),
        Flen_(c.Flen),
        lengthening_((2.0 + 2.0 / c.Af) / (c.Flen - 1.0)),
        end_force_(c.extrapolation_threshold * c.Flen) {
    const double e3 = std::exp(kToeShape);
    toe_strain_ = 99.0 * c.tendon_strain * e3 / (166.0 * e3 - 67.0);
    toe_scale_ = kToeForce / (e3 - 1.0);
    toe_rate_ = kToeShape / toe_strain_;
    tendon_slope_ = (1.0 - kToeForce) / (c.tendon_strain - toe_strain_);
    const double b = lengthening_ * (Flen_ - end_force_);
    end_velocity_ = (end_force_ - 1.0) / b;
    end_slope_ = 1.0 / b + (end_force_ - 1.0) * lengthening_ / (b * b);
  }

  /// The shortest fibre of the curves themselves [L0].
  static constexpr double kMinLength = 0.01;
  /// a fL is taken as at least this: the fibre's velocity stays finite.
  static constexpr double kLeastActive = 1e-12;

  [[nodiscard]] double toe_strain() const { return toe_strain_; }

  /// Tendon force at `length` [LS]. Check: strain 0.04, length 1.02 gives 0.186027557773.
  template <typename Scalar>
  [[nodiscard]] Scalar tendon_force(const Scalar& length) const {
    using std::exp;
    const Scalar strain = length - Scalar(1.0);
    if (strain <= Scalar(0.0)) return Scalar(0.0);
    if (strain > Scalar(toe_strain_)) return Scalar(tendon_slope_) * (strain - Scalar(toe_strain_)) + Scalar(kToeForce);
    return Scalar(toe_scale_) * (exp(Scalar(toe_rate_) * strain) - Scalar(1.0));
  }
  [[nodiscard]] CurveValue tendon(double length) const {
    const double strain = length - 1.0;
    if (strain <= 0.0) return {};
    if (strain > toe_strain_) return {tendon_slope_ * (strain - toe_strain_) + kToeForce, tendon_slope_};
    const double e = std::exp(toe_rate_ * strain);
    return {toe_scale_ * (e - 1.0), toe_scale_ * toe_rate_ * e};
  }
  /// Energy stored in the tendon [F0 LS].
  [[nodiscard]] double tendon_energy(double length) const {
    const double strain = length - 1.0;
    if (strain <= 0.0) return 0.0;
    const auto toe = [&](double e) { return toe_scale_ * (std::expm1(toe_rate_ * e) / toe_rate_ - e); };
    if (strain <= toe_strain_) return toe(strain);
    const double beyond = strain - toe_strain_;
    return toe(toe_strain_) + beyond * (kToeForce + 0.5 * tendon_slope_ * beyond);
  }

  /// Active force-length factor. Check: width 0.45, l = 0.75 gives 0.870324725833.
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

  /// Passive force. Check: class defaults, l = 1.2 gives 0.0291323385009.
  template <typename Scalar>
  [[nodiscard]] Scalar passive_force(const Scalar& l) const {
    using std::exp;
    if (l <= Scalar(1.0)) return Scalar(0.0);
    return Scalar(passive_scale_) * (exp(Scalar(passive_rate_) * (l - Scalar(1.0))) - Scalar(1.0));
  }
  [[nodiscard]] CurveValue passive(double l) const {
    if (l <= 1.0) return {};
    const double e = std::exp(passive_rate_ * (l - 1.0));
    return {passive_scale_ * (e - 1.0), passive_scale_ * passive_rate_ * e};
  }
  /// Energy stored in the passive fibre [F0 L0].
  [[nodiscard]] double passive_energy(double l) const {
    if (l <= 1.0) return 0.0;
    return passive_scale_ * (std::expm1(passive_rate_ * (l - 1.0)) / passive_rate_ - (l - 1.0));
  }

  /// The speed that velocities are in units of [L0/s].
  template <typename Scalar>
  [[nodiscard]] Scalar velocity_unit(const Scalar& /*a*/, const Scalar& Vmax) const {
    return Vmax;
  }

  /// Fibre velocity at activation a, factor fL and active fibre force F = fT/cos(phi) - fPE; straight where F < 0 or
  /// F > threshold a fL Flen. `damping` is not part of this model.
  template <typename Scalar>
  [[nodiscard]] Scalar velocity(const Scalar& a, const Scalar& fL, const Scalar& F, double /*damping*/) const {
    Scalar A = a * fL;
    if (A < Scalar(kLeastActive)) A = Scalar(kLeastActive);
    const Scalar f = F / A;
    const Scalar k = speed_factor(a);
    if (f > Scalar(end_force_)) return k * (Scalar(end_velocity_) + Scalar(end_slope_) * (f - Scalar(end_force_)));
    if (f > Scalar(1.0)) return k * (f - Scalar(1.0)) / (Scalar(lengthening_) * (Scalar(Flen_) - f));
    if (f > Scalar(0.0)) return k * (f - Scalar(1.0)) / (Scalar(1.0) + f * Scalar(inverse_Af_));
    return k * (f * Scalar(1.0 + inverse_Af_) - Scalar(1.0));
  }

  /// Active fibre force a fL fV(v): the inverse of `velocity` in F. Check: class defaults, a = 1, fL = 1, v = -0.2
  /// gives 0.444444444444.
  template <typename Scalar>
  [[nodiscard]] Scalar active_force(const Scalar& a, const Scalar& fL, const Scalar& v) const {
    const Scalar A = a * fL;
    const Scalar w = v / speed_factor(a);
    if (w > Scalar(end_velocity_)) return A * (Scalar(end_force_) + (w - Scalar(end_velocity_)) / Scalar(end_slope_));
    if (w > Scalar(0.0))
      return A * (Scalar(1.0) + w * Scalar(lengthening_ * Flen_)) / (Scalar(1.0) + w * Scalar(lengthening_));
    if (w > Scalar(-1.0)) return A * (Scalar(1.0) + w) / (Scalar(1.0) - w * Scalar(inverse_Af_));
    return A * (w + Scalar(1.0)) / Scalar(1.0 + inverse_Af_);
  }

  template <typename Scalar>
  [[nodiscard]] Scalar activation_rate(const Scalar& u, const Scalar& a, const Scalar& activation_time,
                                       const Scalar& deactivation_time) const {
    return muscle::activation_rate(u, a, activation_time, deactivation_time);
  }

 private:
  static constexpr double kToeForce = 0.33;
  static constexpr double kToeShape = 3.0;

  template <typename Scalar>
  [[nodiscard]] static Scalar speed_factor(const Scalar& a) {
    return Scalar(0.25) + Scalar(0.75) * a;
  }

  double inverse_width_, passive_rate_, passive_scale_, inverse_Af_, Flen_, lengthening_, end_force_;
  double toe_strain_, toe_scale_, toe_rate_, tendon_slope_, end_velocity_, end_slope_;
};

}  // namespace veridyn::muscle
