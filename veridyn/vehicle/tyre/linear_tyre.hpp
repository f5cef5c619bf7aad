#pragma once

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/tyre/tyre.hpp"

namespace veridyn::vehicle {

/// A tyre whose force is proportional to its slip, whatever the load: F_y = C alpha, F_x = C_x kappa, shortened to the
/// friction circle mu F_z where it would be longer (direction kept). With the default infinite mu it is the tyre of the
/// linear bicycle model. The slope jumps at the circle.
template <typename Scalar>
struct LinearTyre {
  /// As a study names it, and whether it needs the friction coefficient `mu` there.
  static constexpr std::string_view kStudyName = "linear";
  static constexpr bool kNeedsFriction = false;

  Scalar stiffness{60000.0};        ///< C [N/rad]
  Scalar slip_stiffness{100000.0};  ///< C_x [N per unit of slip ratio]
  Scalar mu{kInfinity};
  Scalar pneumatic_trail{0.0};  ///< how far behind the wheel's middle the lateral force acts [m]

  [[nodiscard]] TyreForces<Scalar> forces(const Scalar& load, const Scalar& slip_ratio, const Scalar& slip_angle,
                                          const Scalar& /*camber*/) const {
    using std::sqrt;
    Scalar Fx = slip_stiffness * slip_ratio;
    Scalar Fy = stiffness * slip_angle;
    if (!(mu < kInfinity)) return {Fx, Fy};
    const Scalar limit = mu * load;
    const Scalar squared = Fx * Fx + Fy * Fy;
    if (squared <= limit * limit) return {Fx, Fy};
    const Scalar share = limit / sqrt(squared);
    return {share * Fx, share * Fy};
  }

  [[nodiscard]] Scalar cornering_stiffness(const Scalar& /*load*/) const { return stiffness; }

  /// That of a vehicle whose forces and lengths are so many times as large.
  [[nodiscard]] LinearTyre scaled(double force, double length) const {
    return {stiffness * force, slip_stiffness * force, mu, pneumatic_trail * length};
  }

  template <typename Other>
  [[nodiscard]] LinearTyre<Other> cast() const {
    return {Other(stiffness), Other(slip_stiffness), Other(mu), Other(pneumatic_trail)};
  }
};

/// -t F_y [N m], whatever the slip.
template <typename Scalar>
[[nodiscard]] Scalar aligning_moment(const LinearTyre<Scalar>& tyre, const Scalar& load, const Scalar& slip_ratio,
                                     const Scalar& slip_angle, const Scalar& camber) {
  return -tyre.pneumatic_trail * tyre.forces(load, slip_ratio, slip_angle, camber).Fy;
}

template <typename Tyre>
class FourTyres;
/// Declared wherever the tyre is known, so that the general one is never taken for it: see four_linear_tyres.hpp.
template <>
class FourTyres<LinearTyre<double>>;

}  // namespace veridyn::vehicle
