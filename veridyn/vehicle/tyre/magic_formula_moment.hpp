#pragma once

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/tyre/magic_formula.hpp"

namespace veridyn::vehicle {

/// Aligning moment about the vertical axis through the contact point [N m], positive to the left (ISO), by the inputs
/// of `MagicFormulaTyre::forces`. Pacejka, Tyre and Vehicle Dynamics, 2nd ed. (2006), section 4.3.2, (4.E31) to (4.E49)
/// and (4.E71) to (4.E78) with PAC2002's camber terms:
///
///     M_z = -t F_y' + M_zr + s F_x,    t = D_t cos(C_t atan(B_t a_t - E_t (B_t a_t - atan(B_t a_t)))) cos(alpha)
///     M_zr = D_r cos(atan(B_r a_r)) cos(alpha),    F_y' = F_y - S_Vyk
///
/// where at combined slip a_t and a_r are atan(sqrt(tan(a)^2 + (K_x/K_y)^2 kappa^2)) with their sign. 0 of a file
/// without the coefficients QBZ to SSZ.
template <typename Scalar>
[[nodiscard]] Scalar aligning_moment(const MagicFormulaTyre<Scalar>& tyre, const Scalar& load, const Scalar& slip_ratio,
                                     const Scalar& slip_angle, const Scalar& camber) {
  using magic_formula::clamped;
  using std::atan;
  using std::cos;
  using std::sqrt;
  using std::tan;
  const MagicFormulaCoefficients<Scalar>& c = tyre.coefficients;
  const MagicFormulaRange& range = tyre.range;
  const Scalar side(tyre.mirrored ? -1.0 : 1.0);
  const Scalar kappa = clamped(slip_ratio, range.slip_ratio_min, range.slip_ratio_max);
  const Scalar alpha = clamped(Scalar(-side * slip_angle), range.slip_angle_min, range.slip_angle_max);
  const Scalar gamma = clamped(Scalar(side * camber), range.camber_min, range.camber_max);
  const typename MagicFormulaTyre<Scalar>::Terms t = tyre.at(load, gamma);
  const TyreForces<Scalar> force = tyre.combined(load, kappa, alpha, gamma);
  const Scalar lean = gamma * c.LGAZ;
  const Scalar leaning = lean < 0.0 ? Scalar(-lean) : lean;
  const Scalar nominal = c.FNOMIN * c.LFZO;

  // At combined slip both arguments grow to the length of the slip vector (4.E77, 4.E78).
  const Scalar along = t.K_x / t.K_y * kappa;
  const auto equivalent = [&](const Scalar& angle) {
    if (magic_formula::vanishes(along)) return angle;
    const Scalar slope = tan(angle);
    const Scalar squared = slope * slope + along * along;
    if (!(squared > 0.0)) return angle;
    const Scalar length = atan(sqrt(squared));
    return angle < 0.0 ? Scalar(-length) : length;
  };

  const Scalar trail_angle =
      equivalent(Scalar(alpha + c.QHZ1 + c.QHZ2 * t.dfz + (c.QHZ3 + c.QHZ4 * t.dfz) * lean));  // (4.E35)
  const Scalar stiffening = c.LKY / c.LMUY;
  const Scalar B_t =
      (c.QBZ1 + t.dfz * (c.QBZ2 + t.dfz * c.QBZ3)) * (1.0 + c.QBZ4 * lean + c.QBZ5 * leaning) * stiffening;  // (4.E40)
  const Scalar D_t = t.Fz * (c.QDZ1 + c.QDZ2 * t.dfz) * (1.0 + c.QDZ3 * lean + c.QDZ4 * lean * lean) *
                     (c.UNLOADED_RADIUS / nominal) * c.LTR;  // (4.E42, 4.E43)
  const Scalar E_t = magic_formula::curvature(
      Scalar((c.QEZ1 + t.dfz * (c.QEZ2 + t.dfz * c.QEZ3)) *
             (1.0 + (c.QEZ4 + c.QEZ5 * lean) * (2.0 / kPi) * atan(B_t * c.QCZ1 * trail_angle))));             // (4.E44)
  const Scalar trail = D_t * cos(magic_formula::angle(c.QCZ1, E_t, Scalar(B_t * trail_angle))) * cos(alpha);  // (4.E33)

  const Scalar residual_angle = equivalent(Scalar(alpha + t.SH_y + t.SV_y / t.K_y));  // (4.E37, 4.E38)
  const Scalar B_r = c.QBZ9 * stiffening + c.QBZ10 * t.K_y / (t.mu_y * t.Fz);         // (4.E45)
  const Scalar D_r = t.Fz * ((c.QDZ6 + c.QDZ7 * t.dfz) * c.LRES + (c.QDZ8 + c.QDZ9 * t.dfz) * lean) *
                     c.UNLOADED_RADIUS * c.LMUY;  // (4.E47)
  const Scalar turned = B_r * residual_angle;
  const Scalar residual = D_r / sqrt(1.0 + turned * turned) * cos(alpha);  // (4.E36)

  Scalar moment = t.share * residual;
  Scalar lateral = force.Fy;
  if (tyre.combined_slip == CombinedSlip::kWeighting && !magic_formula::vanishes(kappa))
    lateral = lateral - t.share * tyre.induced_Fy(t, kappa, alpha);
  moment = moment - trail * lateral;
  const Scalar arm =
      (c.SSZ1 + c.SSZ2 * force.Fy / nominal + (c.SSZ3 + c.SSZ4 * t.dfz) * lean) * c.UNLOADED_RADIUS * c.LS;  // (4.E76)
  moment = moment + arm * force.Fx;
  return side * moment;
}

}  // namespace veridyn::vehicle
