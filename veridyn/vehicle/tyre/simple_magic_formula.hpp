#pragma once

#include <array>
#include <cmath>

#include "veridyn/vehicle/tyre/fiala_tyre.hpp"
#include "veridyn/vehicle/tyre/magic_formula.hpp"
#include "veridyn/vehicle/tyre/tyre.hpp"

namespace veridyn::vehicle {

/// The Magic Formula in the few numbers that a drive log can determine (Pacejka, Tyre and Vehicle Dynamics, 2nd ed.
/// 2006, section 4.3.1): no shifts, no camber, equal friction in all directions.
///
///     F_y = D sin(C atan(B a - E (B a - atan(B a)))),   D = mu F_z,   B = K/(C D)
///
/// with both load dependences of the full formula in one number each, x = F_z/F_z0:
///
///     K = stiffness x (1 + q^2)/(1 + q^2 x^2)      q = stiffness_saturation (1/PKY2; 0: in proportion to the load)
///     mu = mu/(1 + p (x - 1))                      p = mu_load (-PDY2/PDY1; 0: constant; within [0, 1))
///
/// Combined slip: the vector (K_x kappa, K alpha) is shortened to the curve's value at its length, so that
/// |F| <= mu F_z always. Mirror-symmetric; smooth where F_z > 0 and E <= 1. With C = 1.3, E = 0 the peak is at B a
/// = 2.9.
template <typename Scalar>
struct SimpleMagicFormulaTyre {
  /// As a study names it, and whether it needs the friction coefficient `mu` there.
  static constexpr std::string_view kStudyName = "magic formula";
  static constexpr bool kNeedsFriction = true;

  Scalar stiffness{60000.0};        ///< K at the nominal load [N/rad]
  Scalar slip_stiffness{100000.0};  ///< K_x at the nominal load [N per unit of slip ratio]
  Scalar mu{1.0};                   ///< peak friction at the nominal load
  Scalar C{1.3};                    ///< shape: 1 to 2
  Scalar E{0.0};                    ///< curvature: at most 1
  Scalar nominal_load{4000.0};      ///< F_z0 [N]
  Scalar stiffness_saturation{0.0};
  Scalar mu_load{0.0};
  Scalar pneumatic_trail{0.0};  ///< at small slip and the nominal load [m]

  [[nodiscard]] TyreForces<Scalar> forces(const Scalar& load, const Scalar& slip_ratio, const Scalar& slip_angle,
                                          const Scalar& /*camber*/) const {
    using std::sin;
    using std::sqrt;
    if (!(load > 0.0)) return {};
    const Scalar x = load / nominal_load;
    const Scalar gain = load_gain(x);
    const Scalar Fx = gain * slip_stiffness * slip_ratio;
    const Scalar Fy = gain * stiffness * slip_angle;
    const Scalar squared = Fx * Fx + Fy * Fy;
    if (!(squared > 0.0)) return {Fx, Fy};
    const Scalar linear = sqrt(squared);
    const Scalar D = mu * load / (1.0 + mu_load * (x - 1.0));
    const Scalar y = linear / (C * D);
    const Scalar share = D * sin(magic_formula::angle(C, E, y)) / linear;
    return {share * Fx, share * Fy};
  }

  [[nodiscard]] Scalar cornering_stiffness(const Scalar& load) const {
    if (!(load > 0.0)) return Scalar(0.0);
    return stiffness * load_gain(Scalar(load / nominal_load));
  }

  /// That of a vehicle whose forces and lengths are so many times as large.
  [[nodiscard]] SimpleMagicFormulaTyre scaled(double force, double length) const {
    SimpleMagicFormulaTyre tyre = *this;
    tyre.stiffness *= force;
    tyre.slip_stiffness *= force;
    tyre.nominal_load *= force;
    tyre.pneumatic_trail *= length;
    return tyre;
  }

  /// Its own numbers in a study.
  [[nodiscard]] static constexpr auto study_keys() {
    using Key = TyreKey<SimpleMagicFormulaTyre>;
    return std::array{Key{.name = "C",
                          .value = &SimpleMagicFormulaTyre::C,
                          .meaning = "shape",
                          .is_admissible = [](double value) { return value >= 1.0 && value < 2.0; },
                          .otherwise = "is {:g}; must be from 1 to below 2"},
                      Key{.name = "E",
                          .value = &SimpleMagicFormulaTyre::E,
                          .meaning = "curvature",
                          .is_admissible = [](double value) { return value <= 1.0; },
                          .otherwise = "is {:g}; must be at most 1"},
                      Key{.name = "mu_load",
                          .value = &SimpleMagicFormulaTyre::mu_load,
                          .meaning = "p of mu = mu_0/(1 + p (F_z/F_z0 - 1))",
                          .is_admissible = [](double value) { return value >= 0.0 && value < 1.0; },
                          .otherwise = "must be from 0 to below 1"},
                      Key{.name = "stiffness_saturation",
                          .value = &SimpleMagicFormulaTyre::stiffness_saturation,
                          .meaning = "1/PKY2 of a tyre file; 0: stiffness in proportion to the load"}};
  }

  template <typename Other>
  [[nodiscard]] SimpleMagicFormulaTyre<Other> cast() const {
    return {Other(stiffness),
            Other(slip_stiffness),
            Other(mu),
            Other(C),
            Other(E),
            Other(nominal_load),
            Other(stiffness_saturation),
            Other(mu_load),
            Other(pneumatic_trail)};
  }

  /// K over its value at the nominal load; x = F_z/F_z0.
  [[nodiscard]] Scalar load_gain(const Scalar& x) const {
    const Scalar q = stiffness_saturation * stiffness_saturation;
    return x * (1.0 + q) / (1.0 + q * x * x);
  }
};

/// -t F_y [N m]: the trail in proportion to the load, as that of the full formula, and falling with slip as that of a
/// brush tyre of the same stiffness and friction (`brush_trail`).
template <typename Scalar>
[[nodiscard]] Scalar aligning_moment(const SimpleMagicFormulaTyre<Scalar>& tyre, const Scalar& load,
                                     const Scalar& slip_ratio, const Scalar& slip_angle, const Scalar& camber) {
  using std::sqrt;
  if (!(load > 0.0)) return Scalar(0.0);
  const Scalar x = load / tyre.nominal_load;
  const Scalar moment = -tyre.pneumatic_trail * x * tyre.forces(load, slip_ratio, slip_angle, camber).Fy;
  const Scalar Fx = tyre.slip_stiffness * slip_ratio, Fy = tyre.stiffness * slip_angle;
  const Scalar squared = Fx * Fx + Fy * Fy;
  if (!(squared > 0.0)) return moment;
  const Scalar limit = tyre.mu * load / (1.0 + tyre.mu_load * (x - 1.0));
  return brush_trail(Scalar(tyre.load_gain(x) * sqrt(squared) / (3.0 * limit))) * moment;
}

template <typename Tyre>
class FourTyres;
/// Declared wherever the tyre is known, so that the general one is never taken for it: see
/// four_simple_magic_formula.hpp.
template <>
class FourTyres<SimpleMagicFormulaTyre<double>>;

}  // namespace veridyn::vehicle
