#pragma once

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/tyre/tyre.hpp"

namespace veridyn::vehicle {

/// A brush tyre: the linear tyre with a friction limit that it reaches smoothly. Fiala (1954), VDI-Zeitschrift 96:973;
/// Pacejka, Tyre and Vehicle Dynamics, 2nd ed. (2006), section 3.2 (parabolic pressure, one friction coefficient). With
/// S the length of (C_x kappa, C alpha) and N = mu F_z, along that vector
///
///     F = S - S^2/(3 N) + S^3/(27 N^2)   for S < 3 N,   N beyond: the whole contact patch slides
///
/// The slip angle itself takes the place of its tangent, so that for small slip this is `LinearTyre` with the same
/// numbers. Twice continuously differentiable away from zero slip; at zero slip the slope is continuous.
template <typename Scalar>
struct FialaTyre {
  /// As a study names it, and whether it needs the friction coefficient `mu` there.
  static constexpr std::string_view kStudyName = "fiala";
  static constexpr bool kNeedsFriction = true;

  Scalar stiffness{60000.0};        ///< C [N/rad]
  Scalar slip_stiffness{100000.0};  ///< C_x [N per unit of slip ratio]
  Scalar mu{1.0};                   ///< may be infinite: then the linear tyre
  Scalar pneumatic_trail{0.0};      ///< at small slip [m]; a sixth of the contact's length, with the brush model

  [[nodiscard]] TyreForces<Scalar> forces(const Scalar& load, const Scalar& slip_ratio, const Scalar& slip_angle,
                                          const Scalar& /*camber*/) const {
    using std::sqrt;
    if (!(load > 0.0)) return {};
    const Scalar Fx = slip_stiffness * slip_ratio;
    const Scalar Fy = stiffness * slip_angle;
    const Scalar squared = Fx * Fx + Fy * Fy;
    if (!(squared > 0.0) || !(mu < kInfinity)) return {Fx, Fy};
    const Scalar S = sqrt(squared);
    const Scalar limit = mu * load;
    const Scalar s = S / (3.0 * limit);
    const Scalar share = s < 1.0 ? Scalar(1.0 - s + s * s / 3.0) : Scalar(limit / S);
    return {share * Fx, share * Fy};
  }

  [[nodiscard]] Scalar cornering_stiffness(const Scalar& load) const { return load > 0.0 ? stiffness : Scalar(0.0); }

  /// That of a vehicle whose forces and lengths are so many times as large.
  [[nodiscard]] FialaTyre scaled(double force, double length) const {
    return {stiffness * force, slip_stiffness * force, mu, pneumatic_trail * length};
  }

  template <typename Other>
  [[nodiscard]] FialaTyre<Other> cast() const {
    return {Other(stiffness), Other(slip_stiffness), Other(mu), Other(pneumatic_trail)};
  }
};

/// The share of its pneumatic trail that a brush tyre has left where the force along its slip would be S = 3 s N
/// without friction's limit N: (1 - s)^3/(1 - s + s^2/3), 0 from s = 1 on (Pacejka 2006, section 3.2).
template <typename Scalar>
[[nodiscard]] Scalar brush_trail(const Scalar& s) {
  if (!(s < 1.0)) return Scalar(0.0);
  const Scalar rest = 1.0 - s;
  return rest * rest * rest / (1.0 - s + s * s / 3.0);
}

/// -t F_y with the trail of the brush model [N m].
template <typename Scalar>
[[nodiscard]] Scalar aligning_moment(const FialaTyre<Scalar>& tyre, const Scalar& load, const Scalar& slip_ratio,
                                     const Scalar& slip_angle, const Scalar& camber) {
  using std::sqrt;
  if (!(load > 0.0)) return Scalar(0.0);
  const Scalar moment = -tyre.pneumatic_trail * tyre.forces(load, slip_ratio, slip_angle, camber).Fy;
  const Scalar Fx = tyre.slip_stiffness * slip_ratio, Fy = tyre.stiffness * slip_angle;
  const Scalar squared = Fx * Fx + Fy * Fy;
  if (!(squared > 0.0) || !(tyre.mu < kInfinity)) return moment;
  return brush_trail(Scalar(sqrt(squared) / (3.0 * tyre.mu * load))) * moment;
}

template <typename Tyre>
class FourTyres;
/// Declared wherever the tyre is known, so that the general one is never taken for it: see four_fiala_tyres.hpp.
template <>
class FourTyres<FialaTyre<double>>;

}  // namespace veridyn::vehicle
