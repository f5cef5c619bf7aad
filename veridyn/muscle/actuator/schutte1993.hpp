#pragma once

#include <cmath>
#include <optional>

#include "veridyn/muscle/model/muscle_parameters.hpp"
#include "veridyn/muscle/model/scalar.hpp"

namespace veridyn::muscle {

/// Curves of Schutte, Rodgers, Zajac & Glaser (1993), IEEE Trans Rehabil Eng 1:109, as OpenSim computes them
/// (`Schutte1993Muscle_Deprecated`). Members and units as in `Thelen2003`. Force-length curves and tendon are splines
/// of the file; without one the passive force is exp(8 (l - 1) - 4) at all lengths. Velocities are in units of
/// L0/time_scale, in which Vmax is 1. With A = a fL the force that depends on velocity is
///
///     F = A kv (1 + v)/(kv - v) + d v                    shortening, kv = 0.15
///     F = A (1.4 v + s)/(v + s) + d v                    lengthening, s = 0.13 kv/(1 + kv)
///
/// and forces below zero count as zero, so that a fibre that its tendon does not hold shortens as fast as it can.
class Schutte1993 {
 public:
  explicit Schutte1993(const SchutteCurves& c = {})
      : tendon_(c.tendon), active_(c.active), passive_(c.passive), damping_(c.damping) {}

  static constexpr double kMinLength = 0.01;

  template <typename Scalar>
  [[nodiscard]] Scalar tendon_force(const Scalar& length) const {
    const Scalar strain = length - Scalar(1.0);
    if (strain < Scalar(0.0)) return Scalar(0.0);
    return tendon_.evaluate(strain).value;
  }
  [[nodiscard]] CurveValue tendon(double length) const {
    if (length < 1.0) return {0.0, 0.0};
    const auto f = tendon_.evaluate(length - 1.0);
    return {f.value, f.slope};
  }
  [[nodiscard]] double tendon_energy(double length) const {
    return length > 1.0 ? tendon_.integral(0.0, length - 1.0) : 0.0;
  }

  template <typename Scalar>
  [[nodiscard]] Scalar active_length(const Scalar& l) const {
    const Scalar f = active_.evaluate(l).value;
    return f < Scalar(0.0) ? f * Scalar(0.0) : f;
  }
  [[nodiscard]] CurveValue active(double l) const {
    const auto f = active_.evaluate(l);
    return f.value < 0.0 ? CurveValue{0.0, 0.0} : CurveValue{f.value, f.slope};
  }

  template <typename Scalar>
  [[nodiscard]] Scalar passive_force(const Scalar& l) const {
    using std::exp;
    return passive_ ? passive_->evaluate(l).value : exp(l * Scalar(kRate) - Scalar(kExponent));
  }
  [[nodiscard]] CurveValue passive(double l) const {
    if (!passive_) return {passive_force(l), kRate * passive_force(l)};
    const auto f = passive_->evaluate(l);
    return {f.value, f.slope};
  }
  /// From l = 0 [F0 L0].
  [[nodiscard]] double passive_energy(double l) const {
    return passive_ ? passive_->integral(0.0, l) : (passive_force(l) - passive_force(0.0)) / kRate;
  }

  template <typename Scalar>
  [[nodiscard]] Scalar velocity_unit(const Scalar& /*a*/, const Scalar& Vmax) const {
    return Vmax;
  }

  template <typename Scalar>
  [[nodiscard]] Scalar velocity(const Scalar& a, const Scalar& fL, const Scalar& force, double /*damping*/) const {
    using std::sqrt;
    const Scalar A = a * fL, d(damping_);
    const Scalar F = force < Scalar(0.0) ? force * Scalar(0.0) : force;
    if (F < A) {
      const Scalar b = F + Scalar(kShape) * (A + d), c = Scalar(kShape) * (F - A);
      return (b - sqrt(b * b - Scalar(4.0) * d * c)) / (Scalar(2.0) * d);
    }
    const Scalar b = F - Scalar(kLengthening) * A - Scalar(kSlope) * d, c = Scalar(kSlope) * (A - F);
    return (b + sqrt(b * b - Scalar(4.0) * d * c)) / (Scalar(2.0) * d);
  }

  template <typename Scalar>
  [[nodiscard]] Scalar active_force(const Scalar& a, const Scalar& fL, const Scalar& v) const {
    const Scalar A = a * fL, damping = Scalar(damping_) * v;
    if (v < Scalar(0.0)) return A * Scalar(kShape) * (Scalar(1.0) + v) / (Scalar(kShape) - v) + damping;
    return A * (Scalar(kLengthening) * v + Scalar(kSlope)) / (v + Scalar(kSlope)) + damping;
  }

  /// (u - a) ((1/activation_time - 1/deactivation_time) u + 1/deactivation_time) while u > a, else (u -
  /// a)/deactivation_time.
  template <typename Scalar>
  [[nodiscard]] Scalar activation_rate(const Scalar& u, const Scalar& a, const Scalar& activation_time,
                                       const Scalar& deactivation_time) const {
    const Scalar slow = Scalar(1.0) / deactivation_time;
    return (u - a) * (u > a ? Scalar((Scalar(1.0) / activation_time - slow) * u + slow) : slow);
  }

 private:
  static constexpr double kRate = 8.0, kExponent = 12.0;
  static constexpr double kShape = 0.15, kLengthening = 1.4, kSlope = 0.13 * kShape / (1.0 + kShape);

  numerics::PiecewisePolynomial tendon_, active_;
  std::optional<numerics::PiecewisePolynomial> passive_;
  double damping_;
};

}  // namespace veridyn::muscle
