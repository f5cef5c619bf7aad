#pragma once

#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {

/// Inputs of the wind-axes force equations at one moment.
template <typename Scalar>
struct WindAxesInput {
  Scalar CL{0.0}, CD{0.0}, CY{0.0};   ///< coefficients; CY along body y
  Scalar p{0.0}, q{0.0}, r{0.0};      ///< body rates [rad/s]
  Scalar phi{0.0}, theta{0.0};        ///< attitude [rad]
  Scalar thrust{0.0};                 ///< along body x [N]
  Scalar dynamic_pressure_area{0.0};  ///< qbar S [N]
  double mass = 1.0;                  ///< [kg]
  double gravity = kGravity;          ///< [m/s^2]
};

/// Va', alpha', beta' [m/s^2, rad/s, rad/s].
template <typename Scalar>
struct WindAxesRate {
  Scalar Va{0.0}, alpha{0.0}, beta{0.0};
};

/// The force equations in wind axes in air that moves uniformly (Klein & Morelli 2006, eq. 3.34, with thrust):
///
///     Va'    = -qS CDw/m + T ca cb/m + g (cphi cth sa cb + sphi cth sb - sth ca cb)
///     alpha' = -qS CL/(m Va cb) + q - tb (p ca + r sa) - T sa/(m Va cb) + g (cphi cth ca + sth sa)/(Va cb)
///     beta'  =  qS CYw/(m Va) + p sa - r ca + g cb sphi cth/Va + (sb/Va)(g ca sth - g sa cphi cth - T ca/m)
///     CDw = CD cb - CY sb,  CYw = CY cb + CD sb
///
/// The thrust term of beta' carries a minus (a common misprint is plus); the tests compare with body-axes dynamics.
/// Singular at Va = 0 and beta = +-90 deg.
template <typename Scalar>
[[nodiscard]] WindAxesRate<Scalar> wind_axes_rate(const Scalar& Va, const Scalar& alpha, const Scalar& beta,
                                                  const WindAxesInput<Scalar>& in) {
  using std::cos;
  using std::sin;
  const Scalar ca = cos(alpha), sa = sin(alpha), cb = cos(beta), sb = sin(beta);
  const Scalar cphi = cos(in.phi), sphi = sin(in.phi), cth = cos(in.theta), sth = sin(in.theta);
  const Scalar m(in.mass), g(in.gravity), qS = in.dynamic_pressure_area, T = in.thrust;
  const Scalar CDw = in.CD * cb - in.CY * sb;
  const Scalar CYw = in.CY * cb + in.CD * sb;
  WindAxesRate<Scalar> rate;
  rate.Va = -qS * CDw / m + T * ca * cb / m + g * (cphi * cth * sa * cb + sphi * cth * sb - sth * ca * cb);
  rate.alpha = -qS * in.CL / (m * Va * cb) + in.q - sb / cb * (in.p * ca + in.r * sa) - T * sa / (m * Va * cb) +
               g * (cphi * cth * ca + sth * sa) / (Va * cb);
  rate.beta = qS * CYw / (m * Va) + in.p * sa - in.r * ca + g * cb * sphi * cth / Va +
              sb / Va * (g * ca * sth - g * sa * cphi * cth - T * ca / m);
  return rate;
}

}  // namespace veridyn::aircraft
