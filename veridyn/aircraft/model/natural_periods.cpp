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
  const double per_q = 0.5 * s.chord / at.Va, per_r = 0.5 * s.span / at.Va;
  const auto has = [&](Coefficient which) { return s.model.find(which) != nullptr; };
  if (has(Coefficient::kCL) && has(Coefficient::kCm)) {
    const double drag = has(Coefficient::kCD) && std::isfinite(c.CD.a) ? c.CD.a : 0.0;
    const double Z_alpha = -qS * (c.CL.v[kAlpha] + drag) / momentum, Z_q = -qS * c.CL.v[kQ] * per_q / momentum;
    const double M_alpha = qS * s.chord * c.Cm.v[kAlpha] / s.inertia->Jy;
    const double M_q = qS * s.chord * c.Cm.v[kQ] * per_q / s.inertia->Jy;
    periods.short_period_s = period_of(Z_alpha * M_q - M_alpha * (1.0 + Z_q));
  }
  if (has(Coefficient::kCY) && has(Coefficient::kCn)) {
    const Inertia& J = *s.inertia;
    const double det = J.Jx * J.Jz - J.Jxz * J.Jxz;
    // Rolling accelerates in yaw through the product of inertia.
    const auto yaw = [&](int by) {
      const double roll = has(Coefficient::kCl) && std::isfinite(c.Cl.v[by]) ? c.Cl.v[by] : 0.0;
      return qS * s.span * (J.Jxz * roll + J.Jx * c.Cn.v[by]) / det;
    };
    const double Y_beta = qS * c.CY.v[kBeta] / momentum, Y_r = qS * c.CY.v[kR] * per_r / momentum;
    periods.dutch_roll_s = period_of(Y_beta * yaw(kR) * per_r + yaw(kBeta) * (1.0 - Y_r));
  }
  return periods;
}

}  // namespace veridyn::aircraft
