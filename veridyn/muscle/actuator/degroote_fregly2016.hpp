#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/muscle/actuator/activation_dynamics.hpp"
#include "veridyn/muscle/actuator/damped_velocity.hpp"
#include "veridyn/muscle/model/muscle_parameters.hpp"
#include "veridyn/muscle/model/scalar.hpp"

namespace veridyn::muscle {

/// Curves of De Groote, Kinney, Rao & Fregly (2016), Ann. Biomed. Eng. 44:2922, with OpenSim's constants, which make
/// fT(1) = 0, fL(1) = fV(0) = 1 and fPE(0.2) = 0. Infinitely differentiable. Units as in `Thelen2003`.
///
/// OpenSim's state is the normalised tendon force; here it is the fibre length as for the other muscles. The tendon's
/// curve is strictly increasing, so that one follows from the other and both describe the same motion. With damping the
/// balance is solved for the velocity; OpenSim's explicit mode leaves damping out there.
class DeGrooteFregly2016 {
 public:
  explicit DeGrooteFregly2016(const DeGrooteFregly2016Curves& c = {})
      : inverse_width_(1.0 / c.active_force_width_scale),
        passive_rate_(kPassiveExponent / c.passive_fiber_strain_at_one_norm_force),
        passive_offset_(std::exp(passive_rate_ * (kMinLength - 1.0))),
        passive_scale_(c.ignore_passive_fiber_force ? 0.0 : 1.0 / (std::exp(kPassiveExponent) - passive_offset_)),
        tendon_rate_(std::log((1.0 + kTendon) / kTendon) / c.tendon_strain_at_one_norm_force),
        smoothing_(c.activation_smoothing) {}

  static constexpr double kMinLength = 0.2;
  static constexpr double kLeastActive = 1e-6;  ///< a fL is taken as at least this

  template <typename Scalar>
  [[nodiscard]] Scalar tendon_force(const Scalar& length) const {
    using std::exp;
    return Scalar(kTendon) * (exp(Scalar(tendon_rate_) * (length - Scalar(1.0))) - Scalar(1.0));
  }
  [[nodiscard]] CurveValue tendon(double length) const {
    const double e = kTendon * std::exp(tendon_rate_ * (length - 1.0));
    return {e - kTendon, tendon_rate_ * e};
  }
  /// From slack length [F0 LS].
  [[nodiscard]] double tendon_energy(double length) const {
    return kTendon * (std::expm1(tendon_rate_ * (length - 1.0)) / tendon_rate_ - (length - 1.0));
  }

  /// Check: l = 0.8 gives 0.836439566115.
  template <typename Scalar>
  [[nodiscard]] Scalar active_length(const Scalar& l) const {
    using std::exp;
    const Scalar x = (l - Scalar(1.0)) * Scalar(inverse_width_) + Scalar(1.0);
    Scalar sum(0.0);
    for (const auto& [height, centre, width, slope] : kActive) {
      const Scalar z = (x - Scalar(centre)) / (Scalar(width) + Scalar(slope) * x);
      sum += Scalar(height) * exp(Scalar(-0.5) * z * z);
    }
    return sum;
  }
  [[nodiscard]] CurveValue active(double l) const {
    const double x = (l - 1.0) * inverse_width_ + 1.0;
    CurveValue f;
    for (const auto& [height, centre, width, slope] : kActive) {
      const double w = width + slope * x, z = (x - centre) / w, e = height * std::exp(-0.5 * z * z);
      f.value += e;
      f.slope -= e * z * (1.0 - z * slope) / w * inverse_width_;
    }
    return f;
  }

  template <typename Scalar>
  [[nodiscard]] Scalar passive_force(const Scalar& l) const {
    using std::exp;
    return Scalar(passive_scale_) * (exp(Scalar(passive_rate_) * (l - Scalar(1.0))) - Scalar(passive_offset_));
  }
  [[nodiscard]] CurveValue passive(double l) const {
    const double e = passive_scale_ * std::exp(passive_rate_ * (l - 1.0));
    return {e - passive_scale_ * passive_offset_, passive_rate_ * e};
  }
  /// From l = 0.2 [F0 L0].
  [[nodiscard]] double passive_energy(double l) const {
    return passive_scale_ * ((std::exp(passive_rate_ * (l - 1.0)) - passive_offset_) / passive_rate_ -
                             passive_offset_ * (l - kMinLength));
  }

  template <typename Scalar>
  [[nodiscard]] Scalar velocity_unit(const Scalar& /*a*/, const Scalar& Vmax) const {
    return Vmax;
  }

  template <typename Scalar>
  [[nodiscard]] Scalar force_velocity(const Scalar& v) const {
    using std::log;
    using std::sqrt;
    const Scalar t = Scalar(kVelocity[1]) * v + Scalar(kVelocity[2]);
    // ln(t + sqrt(t^2 + 1)) is odd; its sum is formed without cancellation.
    const Scalar root = sqrt(t * t + Scalar(1.0));
    const Scalar s = t < Scalar(0.0) ? -log(root - t) : log(root + t);
    return Scalar(kVelocity[0]) * s + Scalar(kVelocity[3]);
  }

  template <typename Scalar>
  [[nodiscard]] Scalar velocity(const Scalar& a, const Scalar& fL, const Scalar& F, double damping) const {
    using std::sinh;
    Scalar A = a * fL;
    if (A < Scalar(kLeastActive)) A = Scalar(kLeastActive);
    Scalar s = (F / A - Scalar(kVelocity[3])) * Scalar(1.0 / kVelocity[0]);
    // Beyond, 1e12 times the greatest velocity: held there so that nothing overflows.
    if (s > Scalar(kMaxArgument)) s = Scalar(kMaxArgument);
    if (s < Scalar(-kMaxArgument)) s = Scalar(-kMaxArgument);
    Scalar free = (sinh(s) - Scalar(kVelocity[2])) * Scalar(1.0 / kVelocity[1]);
    if (!(damping > 0.0)) return free;
    // Damping slows down: the root lies between rest and the free velocity, and within (F - A fV)/damping.
    const double v = value_of(free), rest = value_of((F - A) * Scalar(1.0 / damping));
    const double bound = std::abs(v) < std::abs(rest) ? v : rest;
    const auto curve = [this](double x) {
      const double t = kVelocity[1] * x + kVelocity[2], square = t * t + 1.0, root = std::sqrt(square);
      const double slope = kVelocity[0] * kVelocity[1] / root;
      return numerics::FunctionValue<double>{force_velocity(x), slope, -slope * kVelocity[1] * t / square};
    };
    const DampedVelocity begin{value_of(A),          value_of(F),          damping,
                               std::min(bound, 0.0), std::max(bound, 0.0), 0.5 * bound};
    return damped_velocity(A, F, begin, curve);
  }

  template <typename Scalar>
  [[nodiscard]] Scalar active_force(const Scalar& a, const Scalar& fL, const Scalar& v) const {
    return a * fL * force_velocity(v);
  }

  template <typename Scalar>
  [[nodiscard]] Scalar activation_rate(const Scalar& u, const Scalar& a, const Scalar& activation_time,
                                       const Scalar& deactivation_time) const {
    return smooth_activation_rate(u, a, activation_time, deactivation_time, smoothing_);
  }

 private:
  static constexpr double kPassiveExponent = 4.0;
  static constexpr double kTendon = 0.2;
  static constexpr double kMaxArgument = 30.0;
  static constexpr std::array<std::array<double, 4>, 3> kActive{
      {{0.8150671134243542, 1.055033428970575, 0.162384573599574, 0.063303448465465},
       {0.433004984392647, 0.716775413397760, -0.029947116970696, 0.200356847296188},
       {0.1, 1.0, 0.353553390593274, 0.0}}};
  static constexpr std::array<double, 4> kVelocity{-0.3211346127989808, -8.149, -0.374, 0.8825327733249912};

  double inverse_width_, passive_rate_, passive_offset_, passive_scale_, tendon_rate_, smoothing_;
};

}  // namespace veridyn::muscle
