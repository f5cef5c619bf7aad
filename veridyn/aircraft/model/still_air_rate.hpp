#pragma once

#include <cmath>

#include "veridyn/aircraft/model/wind_axes.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::aircraft {

/// What inertial sensors and the air data show at one moment, in body axes.
struct InertialMoment {
  numerics::Vector3<double> specific_force{0.0, 0.0, 0.0};  ///< [m/s^2]
  numerics::Vector3<double> rates{0.0, 0.0, 0.0};           ///< p, q, r [rad/s]
  double phi = 0.0, theta = 0.0;                            ///< attitude [rad]
  double Va = 0.0;                                          ///< [m/s]
  double alpha = 0.0, beta = 0.0;                           ///< [rad]
};

/// Va', alpha', beta' in air that moves uniformly, whatever the aerodynamics: the derivative of
/// v = Va [ca cb, sb, sa cb] with v' = f + g(phi, theta) - omega x v for the specific force f, along the wind axes:
///
///     Va'    = a_x ca cb + a_y sb + a_z sa cb,                               a = f + g(phi, theta)
///     alpha' = q - tan(b) (p ca + r sa) + (a_z ca - a_x sa)/(Va cb)
///     beta'  = p sa - r ca + (a_y cb - (a_x ca + a_z sa) sb)/Va
///
/// The same as `wind_axes_rate` with measured instead of modelled forces. Not finite at Va = 0.
[[nodiscard]] inline WindAxesRate<double> still_air_rate(const InertialMoment& m) {
  const double ca = std::cos(m.alpha), sa = std::sin(m.alpha), cb = std::cos(m.beta), sb = std::sin(m.beta);
  const double p = m.rates(0), q = m.rates(1), r = m.rates(2);
  const double x = m.specific_force(0) - kGravity * std::sin(m.theta);
  const double y = m.specific_force(1) + kGravity * std::cos(m.theta) * std::sin(m.phi);
  const double z = m.specific_force(2) + kGravity * std::cos(m.theta) * std::cos(m.phi);
  return {.Va = x * ca * cb + y * sb + z * sa * cb,
          .alpha = q - sb / cb * (p * ca + r * sa) + (z * ca - x * sa) / (m.Va * cb),
          .beta = p * sa - r * ca + (y * cb - (x * ca + z * sa) * sb) / m.Va};
}

}  // namespace veridyn::aircraft
