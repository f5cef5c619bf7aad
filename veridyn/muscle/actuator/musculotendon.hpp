#pragma once

#include <algorithm>
#include <cmath>
#include <variant>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/actuator/degroote_fregly2016.hpp"
#include "veridyn/muscle/actuator/millard2012.hpp"
#include "veridyn/muscle/actuator/schutte1993.hpp"
#include "veridyn/muscle/actuator/thelen2003.hpp"
#include "veridyn/muscle/actuator/thelen2003_deprecated.hpp"
#include "veridyn/muscle/model/muscle_parameters.hpp"
#include "veridyn/muscle/model/scalar.hpp"

/// One muscle with its tendon: rates of its states, forces, equilibrium.
///
/// States of a muscle are activation a and fibre length lM [m]; with a rigid tendon lM follows from the path and with
/// `ignore_activation_dynamics` a from the excitation, and their rates are 0. The path gives length lMT [m] and speed
/// vMT [m/s] (positive while it lengthens). Fixed-width pennation: height h = L0 sin(phi0), sin(phi) = h/lM,
/// lMT = lM cos(phi) + lT. Forces [N] are tension. Functions neither throw nor allocate; NaN is passed on.
namespace veridyn::muscle {

/// A muscle's curves, prepared for evaluation.
using CompiledCurves = std::variant<Thelen2003, Thelen2003Deprecated, Millard2012, DeGrooteFregly2016, Schutte1993>;

/// @throws InputError naming the muscle and the element: parameters that are not finite or out of range, curves whose
/// shape parameters contradict each other.
void check(const MuscleParameters& parameters);
/// @throws InputError as `check`.
[[nodiscard]] CompiledCurves compile_curves(const MuscleParameters& parameters);

/// What evaluations need of the parameters, computed once.
template <typename Scalar>
struct MusculotendonConstants {
  Scalar F0, L0, LS, Vmax, activation_time, deactivation_time;
  Scalar inverse_L0, height, height_squared, minimum_length;
  Scalar tendon_strain_factor, tendon_slope, tendon_offset;
  double damping = 0.0;  ///< of F0 per Vmax L0; below 0.001 it counts as none
  double minimum_activation = 0.01;
  bool rigid_tendon = false;
  bool ignore_activation_dynamics = false;

  /// `curve_minimum`: the shortest fibre of the curves [L0].
  MusculotendonConstants(const MusculotendonParameters<Scalar>& p, const MuscleParameters& settings,
                         double curve_minimum)
      : F0(p.max_isometric_force),
        L0(p.optimal_fiber_length),
        LS(p.tendon_slack_length),
        Vmax(p.max_contraction_velocity),
        activation_time(p.activation_time_constant),
        deactivation_time(p.deactivation_time_constant),
        inverse_L0(Scalar(1.0) / L0),
        height(sine(p.pennation_angle_at_optimal) * L0),
        height_squared(height * height),
        minimum_length(Scalar(curve_minimum) * L0),
        tendon_strain_factor(p.tendon_strain_factor),
        tendon_slope(Scalar(1.0) / (LS * tendon_strain_factor)),
        tendon_offset(Scalar(1.0) - Scalar(1.0) / tendon_strain_factor),
        damping(settings.fiber_damping < Millard2012::kDampingThreshold ? 0.0 : settings.fiber_damping),
        minimum_activation(settings.minimum_activation),
        rigid_tendon(settings.rigid_tendon),
        ignore_activation_dynamics(settings.ignore_activation_dynamics) {
    const Scalar pennate = height * Scalar(1.0 / std::sin(settings.maximum_pennation_angle));
    if (pennate > minimum_length) minimum_length = pennate;
  }

  /// Where a tendon of this length [m] is on the curves: 1 + (length/LS - 1)/tendon_strain_factor.
  [[nodiscard]] Scalar tendon_stretch(const Scalar& length) const { return length * tendon_slope + tendon_offset; }

 private:
  static Scalar sine(const Scalar& angle) {
    using std::sin;
    return sin(angle);
  }
};

/// Length at which the curves end on the short side [L0].
[[nodiscard]] double minimum_norm_length(const CompiledCurves& curves);
/// Shortest fibre length that the curves allow, in optimal lengths.
[[nodiscard]] inline double minimum_norm_length(const Thelen2003&) { return Thelen2003::kMinLength; }
/// Shortest fibre length that the curves allow, in optimal lengths.
[[nodiscard]] inline double minimum_norm_length(const Thelen2003Deprecated&) {
  return Thelen2003Deprecated::kMinLength;
}
/// Shortest fibre length that the curves allow, in optimal lengths.
[[nodiscard]] inline double minimum_norm_length(const Millard2012& c) { return c.min_length(); }
/// Shortest fibre length that the curves allow, in optimal lengths.
[[nodiscard]] inline double minimum_norm_length(const DeGrooteFregly2016&) { return DeGrooteFregly2016::kMinLength; }
/// Shortest fibre length that the curves allow, in optimal lengths.
[[nodiscard]] inline double minimum_norm_length(const Schutte1993&) { return Schutte1993::kMinLength; }

/// Which limit a muscle is at.
enum class MuscleLimit {
  kNone,
  kShortestFiber,  ///< fibre at its least length and not lengthening: held there, velocity 0
  kSlackTendon,    ///< tendon at or below slack length (rigid tendon: path shorter than the tendon)
};

/// Derivatives of a muscle's states, and its force.
template <typename Scalar>
struct MuscleRates {
  Scalar activation_rate;  ///< [1/s]
  Scalar fiber_velocity;   ///< [m/s]
  Scalar tendon_force;     ///< along the path [N]
};

/// Everything about one state of a muscle.
struct MuscleDetails {
  double activation = 0.0;  ///< the one that acts: within its limits
  double activation_rate = 0.0;
  double fiber_length = 0.0;
  double fiber_velocity = 0.0;
  double pennation = 0.0;         ///< [rad]
  double pennation_rate = 0.0;    ///< [rad/s]
  double tendon_length = 0.0;     ///< [m]
  double tendon_velocity = 0.0;   ///< [m/s]
  double tendon_force = 0.0;      ///< [N]
  double fiber_force = 0.0;       ///< along the fibre, active + passive + damping [N]
  double active_force = 0.0;      ///< F0 a fL fV, along the fibre [N]
  double passive_force = 0.0;     ///< F0 (fPE + damping v), along the fibre [N]
  double active_length = 0.0;     ///< fL
  double force_velocity = 0.0;    ///< fV
  double passive = 0.0;           ///< fPE
  double fiber_stiffness = 0.0;   ///< of the fibre force at fixed fV [N/m]
  double tendon_stiffness = 0.0;  ///< [N/m]; infinite when rigid
  double fiber_energy = 0.0;      ///< stored in the passive fibre [J]
  double tendon_energy = 0.0;     ///< [J]
  MuscleLimit limit = MuscleLimit::kNone;
};

/// How a search for equilibrium ended.
enum class EquilibriumEnd {
  kFound,        ///< forces balance to rounding
  kSlackTendon,  ///< the path is so short that the tendon is slack with the fibre at its least length, which is
                 ///< returned
  kNotFinite,    ///< the input is NaN or infinite; NaN is returned
};

/// Fibre length at which fibre and tendon forces balance at rest.
template <typename Scalar>
struct MuscleEquilibrium {
  Scalar fiber_length;  ///< [m]
  Scalar tendon_force;  ///< [N]
  EquilibriumEnd end = EquilibriumEnd::kFound;
  int evaluations = 0;
};

/// Activation that acts: the excitation when dynamics are ignored, within [minimum, 1].
template <typename Scalar>
[[nodiscard]] Scalar acting_activation(const MusculotendonConstants<Scalar>& k, const Scalar& u, const Scalar& a) {
  const Scalar& x = k.ignore_activation_dynamics ? u : a;
  if (x < Scalar(k.minimum_activation)) return Scalar(k.minimum_activation);
  if (x > Scalar(1.0)) return Scalar(1.0);
  return x;
}

namespace internal {

/// Length along the tendon of a fibre and 1/cos(phi).
template <typename Scalar>
struct Pennation {
  Scalar along, inverse_cosine;
  Pennation(const MusculotendonConstants<Scalar>& k, const Scalar& lM) : along(lM), inverse_cosine(1.0) {
    using std::sqrt;
    if (!(value_of(k.height) > 0.0)) return;
    along = sqrt(lM * lM - k.height_squared);
    inverse_cosine = lM / along;
  }
};

template <typename Scalar>
struct RigidFiber {
  Scalar length, cosine;
  RigidFiber(const MusculotendonConstants<Scalar>& k, const Scalar& along) : length(along), cosine(1.0) {
    using std::sqrt;
    if (!(value_of(k.height) > 0.0)) return;
    length = sqrt(along * along + k.height_squared);
    cosine = along / length;
  }
};

}  // namespace internal

/// Force of the tendon [N] at a fibre length; of the muscle when its tendon is rigid. The quickest question.
template <typename Curves, typename Scalar>
[[nodiscard]] Scalar tendon_force(const Curves& curves, const MusculotendonConstants<Scalar>& k, const Scalar& u,
                                  const Scalar& a, const Scalar& lM, const Scalar& lMT, const Scalar& vMT) {
  if (!k.rigid_tendon) {
    const Scalar held = lM > k.minimum_length ? lM : k.minimum_length;
    const internal::Pennation<Scalar> p(k, held);
    return k.F0 * curves.tendon_force(k.tendon_stretch(lMT - p.along));
  }
  const Scalar along = lMT - k.LS;
  if (!(along > Scalar(0.0))) return along * Scalar(0.0);
  const internal::RigidFiber<Scalar> fiber(k, along);
  const Scalar a_acting = acting_activation(k, u, a);
  const Scalar l = fiber.length * k.inverse_L0;
  const Scalar unit = curves.velocity_unit(a_acting, k.Vmax);
  const Scalar v = vMT * fiber.cosine / (unit * k.L0);
  const Scalar force =
      curves.active_force(a_acting, curves.active_length(l), v) + curves.passive_force(l) + Scalar(k.damping) * v;
  if (!(force > Scalar(0.0))) return force * Scalar(0.0);  // a muscle does not push; NaN stays NaN
  return k.F0 * force * fiber.cosine;
}

/// Rates of both states and the tendon force.
template <typename Curves, typename Scalar>
[[nodiscard]] MuscleRates<Scalar> musculotendon_rates(const Curves& curves, const MusculotendonConstants<Scalar>& k,
                                                      const Scalar& u, const Scalar& a, const Scalar& lM,
                                                      const Scalar& lMT, const Scalar& vMT) {
  MuscleRates<Scalar> rates{Scalar(0.0), Scalar(0.0), Scalar(0.0)};
  const Scalar a_acting = acting_activation(k, u, a);
  if (!k.ignore_activation_dynamics)
    rates.activation_rate = curves.activation_rate(u, a_acting, k.activation_time, k.deactivation_time);
  if (k.rigid_tendon) {
    rates.tendon_force = tendon_force(curves, k, u, a, lM, lMT, vMT);
    return rates;
  }
  const bool shortest = lM <= k.minimum_length;
  const Scalar held = shortest ? k.minimum_length : lM;
  const internal::Pennation<Scalar> p(k, held);
  const Scalar l = held * k.inverse_L0;
  const Scalar fT = curves.tendon_force(k.tendon_stretch(lMT - p.along));
  const Scalar F = fT * p.inverse_cosine - curves.passive_force(l);
  const Scalar v = curves.velocity(a_acting, curves.active_length(l), F, k.damping);
  rates.tendon_force = k.F0 * fT;
  if (!(shortest && v < Scalar(0.0))) rates.fiber_velocity = v * curves.velocity_unit(a_acting, k.Vmax) * k.L0;
  return rates;
}

/// Residual of the static balance along the tendon, of F0, and its slope in lM [1/m].
template <typename Curves>
[[nodiscard]] CurveValue balance(const Curves& curves, const MusculotendonConstants<double>& k, double a, double lM,
                                 double lMT) {
  const internal::Pennation<double> p(k, lM);
  const double l = lM * k.inverse_L0, cosine = 1.0 / p.inverse_cosine;
  const CurveValue fL = curves.active(l), fP = curves.passive(l), fT = curves.tendon(k.tendon_stretch(lMT - p.along));
  const double fiber = a * fL.value + fP.value;
  return {fiber * cosine - fT.value, (a * fL.slope + fP.slope) * k.inverse_L0 * cosine +
                                         fiber * (p.inverse_cosine - cosine) / lM +
                                         fT.slope * k.tendon_slope * p.inverse_cosine};
}

/// Fibre length at which the fibre at rest (fV = 1) balances its tendon, for activation a and path length lMT.
///
/// Newton's method inside a bracket that always holds a root: between the shortest fibre and the one that leaves the
/// tendon half its slack length. It starts with the tendon at 1.01 slack lengths, as OpenSim does, and always ends, as
/// a rule after six evaluations. With dual numbers the root carries the derivatives of the implicit function.
template <typename Curves, typename Scalar>
[[nodiscard]] MuscleEquilibrium<Scalar> musculotendon_equilibrium(const Curves& curves,
                                                                  const MusculotendonConstants<Scalar>& k,
                                                                  const Scalar& a, const Scalar& lMT);

/// Forces along the path as if the tendon were rigid, at the present path length and speed: what static optimisation
/// and CMC ask for.
struct RigidTendonForces {
  double active = 0.0;   ///< F0 a fL fV cos(phi) [N], not below 0
  double passive = 0.0;  ///< F0 (fPE + damping v) cos(phi) [N]
};

/// The same for any scalar: active and passive force.
template <typename Scalar>
struct RigidTendonParts {
  Scalar active, passive;
};

/// 0 when the path is shorter than the tendon or the fibre at its least length.
template <typename Curves, typename Scalar>
[[nodiscard]] RigidTendonParts<Scalar> rigid_tendon_parts(const Curves& curves, const MusculotendonConstants<Scalar>& k,
                                                          const Scalar& a, const Scalar& lMT, const Scalar& vMT) {
  const Scalar along = lMT - k.LS, nothing = along * Scalar(0.0);
  if (!(along > Scalar(0.0))) return {nothing, nothing};
  const internal::RigidFiber<Scalar> fiber(k, along);
  if (fiber.length <= k.minimum_length) return {nothing, nothing};
  const Scalar l = fiber.length * k.inverse_L0;
  const Scalar v = vMT * fiber.cosine / (curves.velocity_unit(a, k.Vmax) * k.L0);
  const Scalar along_tendon = k.F0 * fiber.cosine;
  const Scalar active = curves.active_force(a, curves.active_length(l), v) * along_tendon;
  return {active < Scalar(0.0) ? nothing : active, (curves.passive_force(l) + Scalar(k.damping) * v) * along_tendon};
}

/// Forces of a muscle whose tendon does not stretch.
template <typename Curves>
[[nodiscard]] RigidTendonForces rigid_tendon_forces(const Curves& curves, const MusculotendonConstants<double>& k,
                                                    double a, double lMT, double vMT) {
  const RigidTendonParts<double> parts = rigid_tendon_parts(curves, k, a, lMT, vMT);
  return {parts.active, parts.passive};
}

/// All quantities of one state; for reports and tests, not for inner loops.
template <typename Curves>
[[nodiscard]] MuscleDetails musculotendon_details(const Curves& curves, const MusculotendonConstants<double>& k,
                                                  double u, double a, double lM, double lMT, double vMT);

/// One muscle by itself. `MuscleGroup` is faster for many.
template <typename Scalar>
class Musculotendon {
 public:
  /// @throws InputError naming the muscle when a parameter is wrong.
  explicit Musculotendon(const MuscleParameters& p) : Musculotendon(p, p.musculotendon.template cast<Scalar>()) {}
  /// With `parameters` in place of those in `p`, which still gives curves and settings.
  Musculotendon(const MuscleParameters& p, const MusculotendonParameters<Scalar>& parameters)
      : Musculotendon((check(p), compile_curves(p)), p, parameters) {}
  /// As above, with curves that were compiled before from the same `p`.
  Musculotendon(CompiledCurves curves, const MuscleParameters& p, const MusculotendonParameters<Scalar>& parameters)
      : curves_(std::move(curves)), constants_(parameters, p, minimum_norm_length(curves_)) {}

  [[nodiscard]] const CompiledCurves& curves() const { return curves_; }
  [[nodiscard]] const MusculotendonConstants<Scalar>& constants() const { return constants_; }

  [[nodiscard]] MuscleRates<Scalar> rates(const Scalar& u, const Scalar& a, const Scalar& lM, const Scalar& lMT,
                                          const Scalar& vMT) const {
    return std::visit([&](const auto& c) { return musculotendon_rates(c, constants_, u, a, lM, lMT, vMT); }, curves_);
  }
  [[nodiscard]] Scalar force(const Scalar& u, const Scalar& a, const Scalar& lM, const Scalar& lMT,
                             const Scalar& vMT) const {
    return std::visit([&](const auto& c) { return tendon_force(c, constants_, u, a, lM, lMT, vMT); }, curves_);
  }
  [[nodiscard]] MuscleEquilibrium<Scalar> equilibrium(const Scalar& a, const Scalar& lMT) const {
    return std::visit([&](const auto& c) { return musculotendon_equilibrium(c, constants_, a, lMT); }, curves_);
  }
  [[nodiscard]] MuscleDetails details(double u, double a, double lM, double lMT,
                                      double vMT) const requires std::same_as<Scalar, double> {
    return std::visit([&](const auto& c) { return musculotendon_details(c, constants_, u, a, lM, lMT, vMT); }, curves_);
  }
  [[nodiscard]] RigidTendonForces rigid_forces(double a, double lMT,
                                               double vMT) const requires std::same_as<Scalar, double> {
    return std::visit([&](const auto& c) { return rigid_tendon_forces(c, constants_, a, lMT, vMT); }, curves_);
  }

 private:
  CompiledCurves curves_;
  MusculotendonConstants<Scalar> constants_;
};

// Definitions

namespace internal {

template <typename Scalar>
[[nodiscard]] MusculotendonConstants<double> constants_value(const MusculotendonConstants<Scalar>& k) {
  if constexpr (DualNumber<Scalar>) {
    MuscleParameters settings;
    MusculotendonConstants<double> d({}, settings, 0.0);
    d.F0 = value_of(k.F0);
    d.L0 = value_of(k.L0);
    d.LS = value_of(k.LS);
    d.Vmax = value_of(k.Vmax);
    d.activation_time = value_of(k.activation_time);
    d.deactivation_time = value_of(k.deactivation_time);
    d.inverse_L0 = value_of(k.inverse_L0);
    d.tendon_strain_factor = value_of(k.tendon_strain_factor);
    d.tendon_slope = value_of(k.tendon_slope);
    d.tendon_offset = value_of(k.tendon_offset);
    d.height = value_of(k.height);
    d.height_squared = value_of(k.height_squared);
    d.minimum_length = value_of(k.minimum_length);
    d.damping = k.damping;
    d.minimum_activation = k.minimum_activation;
    d.rigid_tendon = k.rigid_tendon;
    d.ignore_activation_dynamics = k.ignore_activation_dynamics;
    return d;
  } else {
    return k;
  }
}

struct BalanceRoot {
  double lM = 0.0, slope = 1.0;
  EquilibriumEnd end = EquilibriumEnd::kFound;
  int evaluations = 0;
};

template <typename Curves>
[[nodiscard]] BalanceRoot solve_balance(const Curves& curves, const MusculotendonConstants<double>& k, double a,
                                        double lMT) {
  BalanceRoot root;
  const auto fiber = [&](double tendon) {
    const double along = std::max(lMT - tendon, 0.0);
    return std::max(k.minimum_length, std::sqrt(along * along + k.height_squared));
  };
  if (!std::isfinite(lMT) || !std::isfinite(a)) return {std::nan(""), 1.0, EquilibriumEnd::kNotFinite, 0};
  double low = k.minimum_length, high = fiber(0.5 * k.LS);
  CurveValue g = balance(curves, k, a, low, lMT);
  root.evaluations = 1;
  if (std::isnan(g.value)) return {std::nan(""), 1.0, EquilibriumEnd::kNotFinite, 1};
  if (g.value >= 0.0) return {low, g.slope, EquilibriumEnd::kSlackTendon, 1};
  // Only a tendon that pulls when slack can leave no root so far.
  while (balance(curves, k, a, high, lMT).value < 0.0 && root.evaluations < 60) {
    low = high;
    high *= 1.2;
    ++root.evaluations;
  }
  double x = std::clamp(fiber(1.01 * k.LS), low, high), last = high - low;
  for (int i = 0; i < 200; ++i) {
    g = balance(curves, k, a, x, lMT);
    ++root.evaluations;
    (g.value < 0.0 ? low : high) = x;
    double next = x - g.value / g.slope;
    // Newton's error is of the order of the square of its step.
    if (std::abs(next - x) <= 1e-11 * x) {
      x = std::clamp(next, low, high);
      break;
    }
    // A step that leaves the bracket, or is not half the last one, is replaced by halving.
    if (!(next > low && next < high) || std::abs(next - x) > 0.5 * last) next = 0.5 * (low + high);
    last = std::abs(next - x);
    x = next;
  }
  root.lM = x;
  root.slope = balance(curves, k, a, x, lMT).slope;
  return root;
}

}  // namespace internal

template <typename Curves, typename Scalar>
MuscleEquilibrium<Scalar> musculotendon_equilibrium(const Curves& curves, const MusculotendonConstants<Scalar>& k,
                                                    const Scalar& a_in, const Scalar& lMT) {
  const Scalar a = acting_activation(k, a_in, a_in);
  if (k.rigid_tendon) {
    const Scalar along = lMT - k.LS;
    const bool slack = !(along > Scalar(0.0));
    const internal::RigidFiber<Scalar> fiber(k, slack ? Scalar(0.0) : along);
    const EquilibriumEnd end = !std::isfinite(value_of(along)) ? EquilibriumEnd::kNotFinite
                               : slack                         ? EquilibriumEnd::kSlackTendon
                                                               : EquilibriumEnd::kFound;
    return {fiber.length, tendon_force(curves, k, a, a, fiber.length, lMT, Scalar(0.0)), end, 1};
  }
  const internal::BalanceRoot root =
      internal::solve_balance(curves, internal::constants_value(k), value_of(a), value_of(lMT));
  MuscleEquilibrium<Scalar> result{Scalar(root.lM), Scalar(0.0), root.end, root.evaluations};
  if (root.end == EquilibriumEnd::kSlackTendon) result.fiber_length = k.minimum_length;
  if constexpr (DualNumber<Scalar>) {
    if (root.end == EquilibriumEnd::kFound) {
      const internal::Pennation<Scalar> p(k, result.fiber_length);
      const Scalar l = result.fiber_length * k.inverse_L0;
      const Scalar residual = (a * curves.active_length(l) + curves.passive_force(l)) / p.inverse_cosine -
                              curves.tendon_force(k.tendon_stretch(lMT - p.along));
      result.fiber_length.v -= residual.v / root.slope;
    }
  }
  const internal::Pennation<Scalar> p(k, result.fiber_length);
  result.tendon_force = k.F0 * curves.tendon_force(k.tendon_stretch(lMT - p.along));
  return result;
}

template <typename Curves>
MuscleDetails musculotendon_details(const Curves& curves, const MusculotendonConstants<double>& k, double u, double a,
                                    double lM, double lMT, double vMT) {
  MuscleDetails d;
  const MuscleRates<double> rates = musculotendon_rates(curves, k, u, a, lM, lMT, vMT);
  d.activation = acting_activation(k, u, a);
  d.activation_rate = rates.activation_rate;
  d.tendon_force = rates.tendon_force;
  const double unit = curves.velocity_unit(d.activation, k.Vmax) * k.L0;
  double cosine = 1.0;
  if (k.rigid_tendon) {
    const double along = std::max(0.0, lMT - k.LS);
    const internal::RigidFiber<double> fiber(k, along);
    d.fiber_length = fiber.length;
    cosine = fiber.cosine;
    const bool slack = !(lMT > k.LS);
    d.fiber_velocity = slack ? 0.0 : vMT * cosine;
    d.tendon_length = slack ? lMT : k.LS;
    d.tendon_stiffness = kInfinity;
    if (slack) d.limit = MuscleLimit::kSlackTendon;
  } else {
    d.fiber_length = std::max(lM, k.minimum_length);
    const internal::Pennation<double> p(k, d.fiber_length);
    cosine = 1.0 / p.inverse_cosine;
    d.fiber_velocity = rates.fiber_velocity;
    d.tendon_length = lMT - p.along;
    d.tendon_velocity = vMT - d.fiber_velocity / cosine;
    const double stretch = k.tendon_stretch(d.tendon_length);
    d.tendon_stiffness = k.F0 * k.tendon_slope * curves.tendon(stretch).slope;
    d.tendon_energy = k.F0 * k.LS * k.tendon_strain_factor * curves.tendon_energy(stretch);
    if (d.tendon_length <= k.LS) d.limit = MuscleLimit::kSlackTendon;
    if (lM <= k.minimum_length && d.fiber_velocity == 0.0) d.limit = MuscleLimit::kShortestFiber;
  }
  const double l = d.fiber_length * k.inverse_L0, v = d.fiber_velocity / unit;
  const CurveValue fL = curves.active(l), fP = curves.passive(l);
  const double sine = std::min(1.0, k.height / d.fiber_length);
  d.pennation = std::asin(sine);
  d.pennation_rate = cosine > 0.0 ? -d.fiber_velocity / d.fiber_length * sine / cosine : 0.0;
  d.active_length = fL.value;
  d.passive = fP.value;
  // Where nothing is active fV still has a value.
  const double a_least = std::max(d.activation, 1e-9), fL_least = std::max(fL.value, 1e-9);
  d.force_velocity = curves.active_force(a_least, fL_least, v) / (a_least * fL_least);
  d.active_force = k.F0 * curves.active_force(d.activation, fL.value, v);
  d.passive_force = k.F0 * (fP.value + k.damping * v);
  d.fiber_force = d.active_force + d.passive_force;
  d.fiber_stiffness = k.F0 * k.inverse_L0 * (d.activation * fL.slope * d.force_velocity + fP.slope);
  d.fiber_energy = k.F0 * k.L0 * curves.passive_energy(l);
  return d;
}

}  // namespace veridyn::muscle
