#include "veridyn/aircraft/model/natural_periods.hpp"

#include <ceres/jet.h>

#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

/// Nothing unless stiff.
std::optional<double> period_of(double squared_frequency) {
  if (!(squared_frequency > 0.0)) return std::nullopt;
  return kFullTurn / std::sqrt(squared_frequency);
}

}  // namespace

NaturalPeriods natural_periods(const Subject& s, const AeroVariables<double>& at, double rho) {
  NaturalPeriods periods;
  if (!s.inertia) return periods;
  enum Derivative : int { kAlpha, kBeta, kP, kQ, kR, kCount };
  using Jet = ceres::Jet<double, kCount>;
  AeroVariables<Jet> v;
  v.alpha = Jet(at.alpha, kAlpha);
  v.beta = Jet(at.beta, kBeta);
  v.p_n = Jet(at.p_n, kP);
  v.q_n = Jet(at.q_n, kQ);
  v.r_n = Jet(at.r_n, kR);
  v.de = Jet(at.de);
  v.da = Jet(at.da);
  v.dr = Jet(at.dr);
  v.CT = Jet(at.CT);
  v.Va = Jet(at.Va);
  const AeroCoefficients<Jet> c = s.model.evaluate(v);
  const double qS = 0.5 * rho * at.Va * at.Va * s.wing_area, momentum = s.mass * at.Va;
  const double per_q = 0.5 * s.pitch_length() / at.Va, per_r = 0.5 * s.yaw_length() / at.Va;
  // A coefficient that is not known acts as none.
  const auto valid = [&](Coefficient which, const Jet& value) {
    return s.model.find(which) != nullptr && std::isfinite(value.a);
  };
  const auto known = [&](Coefficient which, const Jet& value) {
    return valid(which, value) ? Jet(Jet(qS) * value) : Jet(0.0);
  };
  const Jet lift = known(Coefficient::kCL, c.CL), drag = known(Coefficient::kCD, c.CD);
  const Jet ca = cos(v.alpha), sa = sin(v.alpha);
  // Force and moment in body axes; the force acts off the centre of gravity.
  const Jet X = lift * sa - drag * ca, Y = known(Coefficient::kCY, c.CY), Z = -drag * sa - lift * ca;
  const auto& f = s.force_point;
  const Jet L = Jet(s.roll_length()) * known(Coefficient::kCl, c.Cl) + f[1] * Z - f[2] * Y;
  const Jet M = Jet(s.pitch_length()) * known(Coefficient::kCm, c.Cm) + f[2] * X - f[0] * Z;
  const Jet N = Jet(s.yaw_length()) * known(Coefficient::kCn, c.Cn) + f[0] * Y - f[1] * X;
  if (valid(Coefficient::kCL, c.CL) && valid(Coefficient::kCm, c.Cm)) {
    const double Z_alpha = -(lift.v[kAlpha] + drag.a) / momentum, Z_q = -lift.v[kQ] * per_q / momentum;
    const double M_alpha = M.v[kAlpha] / s.inertia->Jy, M_q = M.v[kQ] * per_q / s.inertia->Jy;
    periods.short_period_s = period_of(Z_alpha * M_q - M_alpha * (1.0 + Z_q));
  }
  if (valid(Coefficient::kCY, c.CY) && valid(Coefficient::kCn, c.Cn)) {
    const Inertia& J = *s.inertia;
    // Rolling accelerates in yaw through the product of inertia.
    const Jet yaw = (J.Jxz * L + J.Jx * N) / (J.Jx * J.Jz - J.Jxz * J.Jxz);
    const double Y_beta = Y.v[kBeta] / momentum, Y_r = Y.v[kR] * per_r / momentum;
    periods.dutch_roll_s = period_of(Y_beta * yaw.v[kR] * per_r + yaw.v[kBeta] * (1.0 - Y_r));
  }
  return periods;
}

}  // namespace veridyn::aircraft
