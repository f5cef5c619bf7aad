#pragma once

#include <cmath>
#include <type_traits>

#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/tyre/magic_formula_coefficients.hpp"
#include "veridyn/vehicle/tyre/tyre.hpp"

namespace veridyn::vehicle {

/// How a Magic Formula tyre shares its friction between driving and cornering.
enum class CombinedSlip {
  /// By the weighting functions of the R coefficients (Pacejka 2006, 4.E50 to 4.E67).
  kWeighting,
  /// By an equivalent slip, for files without R coefficients: both slips, each in units of friction over
  /// stiffness, make one vector; each pure curve is taken at that vector's length and shared by its direction. Pure
  /// slip is reproduced exactly, and without shifts the force stays within the friction ellipse.
  kEquivalentSlip,
  kNone  ///< each force as if alone: beyond the friction circle by up to sqrt(2)
};

/// Where, by its file, a tyre's coefficients hold. Slips and camber beyond are taken at the limit.
struct MagicFormulaRange {
  double load_min = 0.0;
  double load_max = kInfinity;  ///< [N]
  double slip_ratio_min = -kInfinity;
  double slip_ratio_max = kInfinity;
  double slip_angle_min = -kInfinity;  ///< file convention [rad]
  double slip_angle_max = kInfinity;
  double camber_min = -kInfinity;  ///< file convention [rad]
  double camber_max = kInfinity;
};

/// The Magic Formula of PAC2002 / MF-Tyre 5.2: steady-state forces at pure and combined slip with load dependence and
/// camber, without turn slip. Pacejka, Tyre and Vehicle Dynamics, 2nd ed. (2006), section 4.3.2, equations (4.E9) to
/// (4.E30) and (4.E50) to (4.E67), with the camber terms of PAC2002, which tyre files are made for:
///
///     F_x0 = D_x sin(C_x atan(B_x k_x - E_x (B_x k_x - atan(B_x k_x)))) + S_Vx,   k_x = kappa + S_Hx
///     F_y0 = D_y sin(C_y atan(B_y a_y - E_y (B_y a_y - atan(B_y a_y)))) + S_Vy,   a_y = alpha + S_Hy
///     K_y  = PKY1 F_z0 sin(2 atan(F_z/(PKY2 F_z0))) (1 - PKY3 |gamma|)
///     F_x = G_xa(alpha, kappa) F_x0,   F_y = G_yk(kappa, alpha) F_y0 + S_Vyk
///
/// Two layers. `Fx0`, `Fy0` and `combined` use the tyre file's convention (ISO, TYDEX W axes): x forward, y left,
/// camber positive with the top to the right, but slip angle +atan(V_y/|V_x|). `forces` uses the project's
/// (`tyre.hpp`): the same but for the slip angle, whose sign it turns.
///
/// Shifts make a real tyre unsymmetric: it belongs to one side of the car. `mirrored` makes it the one for the other
/// side; with `t` on the left and `t.on_other_side()` on the right a car is symmetric. A model with one tyre per axle
/// and no notion of sides keeps the small side force of the shifts, unless it uses `symmetric()`.
///
/// Load: below `range.load_min` (at least 1 % of nominal) forces shrink in proportion to the load from their values
/// there, to 0 at 0; above `range.load_max` they stay. Curvatures E above 1, where the curve would fold back, are taken
/// as 1; weights below 0 as 0; a longitudinal stiffness per load below a tenth of nominal, to which the linear fits of
/// some files fall at high load, as that tenth. Continuous everywhere; slopes jump at those limits and (files with
/// PEX4, PEY3, PEY4) the curvature at zero slip. Does not throw or allocate.
template <typename Scalar>
struct MagicFormulaTyre {
  MagicFormulaCoefficients<Scalar> coefficients;
  MagicFormulaRange range;
  CombinedSlip combined_slip = CombinedSlip::kEquivalentSlip;
  bool mirrored = false;

  /// Forces by the project's convention (`tyre.hpp`).
  [[nodiscard]] TyreForces<Scalar> forces(const Scalar& load, const Scalar& slip_ratio, const Scalar& slip_angle,
                                          const Scalar& camber) const;

  /// dF_y/d(slip angle) at zero slip and camber [N/rad]; shifts move the working point, so this is not quite |K_y|.
  [[nodiscard]] Scalar cornering_stiffness(const Scalar& load) const;

  // In the file's convention, not mirrored. Slips and camber inside the range.
  [[nodiscard]] Scalar Fx0(const Scalar& load, const Scalar& kappa, const Scalar& gamma) const;
  [[nodiscard]] Scalar Fy0(const Scalar& load, const Scalar& alpha, const Scalar& gamma) const;
  [[nodiscard]] TyreForces<Scalar> combined(const Scalar& load, const Scalar& kappa, const Scalar& alpha,
                                            const Scalar& gamma) const;

  /// Peak friction coefficients at a load and camber (file convention).
  [[nodiscard]] Scalar mu_x(const Scalar& load, const Scalar& gamma) const { return at(load, gamma).mu_x; }
  [[nodiscard]] Scalar mu_y(const Scalar& load, const Scalar& gamma) const { return at(load, gamma).mu_y; }

  [[nodiscard]] MagicFormulaTyre on_other_side() const {
    MagicFormulaTyre other = *this;
    other.mirrored = !mirrored;
    return other;
  }

  /// The same tyre without the asymmetry of left and right (and, of longitudinal shifts, driving from braking at zero
  /// slip): all shifts that do not come from camber, RBY3 and the sign terms of the lateral curvature are 0.
  [[nodiscard]] MagicFormulaTyre symmetric() const;

  /// That of a vehicle whose forces and lengths are so many times as large: all coefficients of tyre files but the
  /// nominal load and the radius are dimensionless.
  [[nodiscard]] MagicFormulaTyre scaled(double force, double length) const {
    MagicFormulaTyre tyre = *this;
    tyre.coefficients.FNOMIN *= force;
    tyre.coefficients.UNLOADED_RADIUS *= length;
    tyre.range.load_min *= force;
    tyre.range.load_max *= force;
    return tyre;
  }

  template <typename Other>
  [[nodiscard]] MagicFormulaTyre<Other> cast() const {
    return {coefficients.template cast<Other>(), range, combined_slip, mirrored};
  }

  /// What load and camber alone decide.
  struct Terms {
    Scalar Fz;          ///< the load inside the range
    Scalar share;       ///< of the forces at that load, below the range
    Scalar dfz;         ///< (Fz - F_z0)/F_z0
    Scalar mu_x, mu_y;  ///< friction
    Scalar K_x, K_y;    ///< slip stiffnesses [N]; K_y is negative
    Scalar SH_x, SV_x, SH_y, SV_y;
    Scalar gamma;  ///< scaled for F_y
  };
  [[nodiscard]] Terms at(const Scalar& load, const Scalar& gamma) const;

  /// S_Vyk, the side force that a slip ratio adds, (4.E66) and (4.E67); file convention.
  [[nodiscard]] Scalar induced_Fy(const Terms& t, const Scalar& kappa, const Scalar& alpha) const;

 private:
  [[nodiscard]] Scalar Fx0(const Terms& t, const Scalar& kappa) const;
  [[nodiscard]] Scalar Fy0(const Terms& t, const Scalar& alpha) const;
  [[nodiscard]] Scalar curvature_y(const Terms& t, const Scalar& shifted) const;
  [[nodiscard]] TyreForces<Scalar> weighted(const Terms& t, const Scalar& kappa, const Scalar& alpha) const;
  [[nodiscard]] TyreForces<Scalar> shared(const Terms& t, const Scalar& kappa, const Scalar& alpha) const;
};

namespace magic_formula {

/// x between two limits; its derivatives vanish beyond them.
template <typename Scalar>
[[nodiscard]] Scalar clamped(const Scalar& x, double lowest, double highest) {
  if (x < lowest) return Scalar(lowest);
  if (x > highest) return Scalar(highest);
  return x;
}

/// Whether a term may be left out: zero, and a plain number (a zero with derivatives still has those).
template <typename Scalar>
[[nodiscard]] bool vanishes(const Scalar& x) {
  if constexpr (std::is_floating_point_v<Scalar>) return x == 0.0;
  return false;
}

/// The argument of the sine or cosine: C atan(y - E (y - atan(y))).
template <typename Scalar>
[[nodiscard]] Scalar angle(const Scalar& C, const Scalar& E, const Scalar& y) {
  using std::atan;
  if (vanishes(E)) return C * atan(y);
  return C * atan(y - E * (y - atan(y)));
}

/// A curvature factor, at most 1.
template <typename Scalar>
[[nodiscard]] Scalar curvature(const Scalar& E) {
  return E > 1.0 ? Scalar(1.0) : E;
}

/// cos(angle(slip + shift))/cos(angle(shift)), at least 0: 1 at zero slip.
template <typename Scalar>
[[nodiscard]] Scalar weight(const Scalar& B, const Scalar& C, const Scalar& E, const Scalar& shift,
                            const Scalar& slip) {
  using std::cos;
  if (vanishes(slip)) return Scalar(1.0);
  Scalar G = cos(angle(C, E, Scalar(B * (slip + shift))));
  if (!vanishes(shift)) G = G / cos(angle(C, E, Scalar(B * shift)));
  return G < 0.0 ? Scalar(0.0) : G;
}

}  // namespace magic_formula

template <typename Scalar>
typename MagicFormulaTyre<Scalar>::Terms MagicFormulaTyre<Scalar>::at(const Scalar& load, const Scalar& gamma) const {
  using magic_formula::vanishes;
  using std::exp;
  const MagicFormulaCoefficients<Scalar>& c = coefficients;
  Terms t;
  const Scalar nominal = c.FNOMIN * c.LFZO;
  Scalar lowest = 0.01 * nominal;
  if (lowest < range.load_min) lowest = Scalar(range.load_min);
  t.Fz = load;
  t.share = Scalar(1.0);
  if (load < lowest) {
    t.Fz = lowest;
    t.share = load < 0.0 ? Scalar(0.0) : Scalar(load / lowest);
  } else if (load > range.load_max) {
    t.Fz = Scalar(range.load_max);
  }
  const Scalar ratio = t.Fz / nominal;
  t.dfz = ratio - 1.0;

  const Scalar gamma_x = gamma * c.LGAX;
  t.mu_x = (c.PDX1 + c.PDX2 * t.dfz) * (1.0 - c.PDX3 * gamma_x * gamma_x) * c.LMUX;  // (4.E13)
  Scalar stiffness = c.PKX1 + c.PKX2 * t.dfz;
  if (stiffness < 0.1 * c.PKX1) stiffness = 0.1 * c.PKX1;
  t.K_x = t.Fz * stiffness * c.LKX;  // (4.E15)
  if (!vanishes(c.PKX3)) t.K_x = t.K_x * exp(c.PKX3 * t.dfz);
  t.SH_x = (c.PHX1 + c.PHX2 * t.dfz) * c.LHX;                  // (4.E17)
  t.SV_x = t.Fz * (c.PVX1 + c.PVX2 * t.dfz) * c.LVX * c.LMUX;  // (4.E18)

  t.gamma = gamma * c.LGAY;
  const Scalar leaning = t.gamma < 0.0 ? Scalar(-t.gamma) : t.gamma;
  t.mu_y = (c.PDY1 + c.PDY2 * t.dfz) * (1.0 - c.PDY3 * t.gamma * t.gamma) * c.LMUY;  // (4.E23)
  const Scalar x = ratio / c.PKY2;  // (4.E25) with sin(2 atan(x)) = 2 x/(1 + x^2)
  t.K_y = c.PKY1 * nominal * (2.0 * x / (1.0 + x * x)) * (1.0 - c.PKY3 * leaning) * c.LKY;
  t.SH_y = (c.PHY1 + c.PHY2 * t.dfz) * c.LHY + c.PHY3 * t.gamma;  // (4.E27), PAC2002
  t.SV_y = t.Fz * ((c.PVY1 + c.PVY2 * t.dfz) * c.LVY + (c.PVY3 + c.PVY4 * t.dfz) * t.gamma) * c.LMUY;  // (4.E29)
  return t;
}

template <typename Scalar>
Scalar MagicFormulaTyre<Scalar>::Fx0(const Terms& t, const Scalar& kappa) const {
  using std::sin;
  const MagicFormulaCoefficients<Scalar>& c = coefficients;
  const Scalar shifted = kappa + t.SH_x;
  if (magic_formula::vanishes(shifted)) return t.SV_x;
  const Scalar sign(shifted < 0.0 ? -1.0 : 1.0);
  const Scalar E = magic_formula::curvature(
      Scalar((c.PEX1 + t.dfz * (c.PEX2 + t.dfz * c.PEX3)) * (1.0 - c.PEX4 * sign) * c.LEX));  // (4.E14)
  const Scalar C = c.PCX1 * c.LCX;
  const Scalar D = t.mu_x * t.Fz;
  const Scalar y = t.K_x / (C * D) * shifted;
  return D * sin(magic_formula::angle(C, E, y)) + t.SV_x;  // (4.E9)
}

template <typename Scalar>
Scalar MagicFormulaTyre<Scalar>::curvature_y(const Terms& t, const Scalar& shifted) const {
  const MagicFormulaCoefficients<Scalar>& c = coefficients;
  const Scalar sign(shifted < 0.0 ? -1.0 : 1.0);
  return magic_formula::curvature(
      Scalar((c.PEY1 + c.PEY2 * t.dfz) * (1.0 - (c.PEY3 + c.PEY4 * t.gamma) * sign) * c.LEY));  // (4.E24)
}

template <typename Scalar>
Scalar MagicFormulaTyre<Scalar>::Fy0(const Terms& t, const Scalar& alpha) const {
  using std::sin;
  const Scalar shifted = alpha + t.SH_y;
  const Scalar C = coefficients.PCY1 * coefficients.LCY;
  const Scalar D = t.mu_y * t.Fz;
  const Scalar y = t.K_y / (C * D) * shifted;
  return D * sin(magic_formula::angle(C, curvature_y(t, shifted), y)) + t.SV_y;  // (4.E19)
}

template <typename Scalar>
TyreForces<Scalar> MagicFormulaTyre<Scalar>::weighted(const Terms& t, const Scalar& kappa, const Scalar& alpha) const {
  using magic_formula::vanishes;
  using std::sqrt;
  const MagicFormulaCoefficients<Scalar>& c = coefficients;
  TyreForces<Scalar> out{Fx0(t, kappa), Fy0(t, alpha)};
  // cos(atan(x)) = 1/sqrt(1 + x^2). A force that is 0 needs no weight: a rolling wheel without shifts.
  if (!vanishes(out.Fx)) {
    const Scalar slope = c.RBX2 * kappa;
    const Scalar B = c.RBX1 * c.LXAL / sqrt(1.0 + slope * slope);  // (4.E54)
    const Scalar E = magic_formula::curvature(Scalar(c.REX1 + c.REX2 * t.dfz));
    out.Fx *= magic_formula::weight(B, c.RCX1, E, c.RHX1, alpha);
  }
  if (!vanishes(kappa)) {
    const Scalar slope = c.RBY2 * (alpha - c.RBY3);
    const Scalar B = c.RBY1 * c.LYKA / sqrt(1.0 + slope * slope);  // (4.E62)
    const Scalar E = magic_formula::curvature(Scalar(c.REY1 + c.REY2 * t.dfz));
    const Scalar shift = c.RHY1 + c.RHY2 * t.dfz;
    out.Fy = out.Fy * magic_formula::weight(B, c.RCY1, E, shift, kappa) + induced_Fy(t, kappa, alpha);
  }
  return out;
}

template <typename Scalar>
Scalar MagicFormulaTyre<Scalar>::induced_Fy(const Terms& t, const Scalar& kappa, const Scalar& alpha) const {
  using std::atan;
  using std::sin;
  using std::sqrt;
  const MagicFormulaCoefficients<Scalar>& c = coefficients;
  const Scalar slope = c.RVY4 * alpha;
  const Scalar D = t.mu_y * t.Fz * (c.RVY1 + c.RVY2 * t.dfz + c.RVY3 * t.gamma) / sqrt(1.0 + slope * slope);
  return D * sin(c.RVY5 * atan(c.RVY6 * kappa)) * c.LVYKA;
}

template <typename Scalar>
TyreForces<Scalar> MagicFormulaTyre<Scalar>::shared(const Terms& t, const Scalar& kappa, const Scalar& alpha) const {
  using std::sqrt;
  const Scalar unit_x = t.mu_x * t.Fz / t.K_x;
  const Scalar unit_y = -(t.mu_y * t.Fz / t.K_y);
  const Scalar x = kappa / unit_x;
  const Scalar y = alpha / unit_y;
  // Along an axis the curves are the pure ones, and the length of the vector has no useful derivative at 0.
  if (magic_formula::vanishes(kappa)) return {Fx0(t, kappa), Fy0(t, alpha)};
  if (magic_formula::vanishes(alpha)) return {Fx0(t, kappa), Fy0(t, alpha)};
  const Scalar squared = x * x + y * y;
  if (!(squared > 0.0)) return {Fx0(t, kappa), Fy0(t, alpha)};
  const Scalar length = sqrt(squared);
  const Scalar none(0.0);
  const auto along = [&](const Scalar& part, const Scalar& at_length, const Scalar& at_rest) {
    const Scalar share = (part < 0.0 ? Scalar(-part) : part) / length;
    return Scalar(at_rest + share * (at_length - at_rest));
  };
  const Scalar sign_x(x < 0.0 ? -1.0 : 1.0);
  const Scalar sign_y(y < 0.0 ? -1.0 : 1.0);
  return {along(x, Fx0(t, Scalar(sign_x * length * unit_x)), Fx0(t, none)),
          along(y, Fy0(t, Scalar(sign_y * length * unit_y)), Fy0(t, none))};
}

template <typename Scalar>
Scalar MagicFormulaTyre<Scalar>::Fx0(const Scalar& load, const Scalar& kappa, const Scalar& gamma) const {
  const Terms t = at(load, gamma);
  return t.share * Fx0(t, kappa);
}

template <typename Scalar>
Scalar MagicFormulaTyre<Scalar>::Fy0(const Scalar& load, const Scalar& alpha, const Scalar& gamma) const {
  const Terms t = at(load, gamma);
  return t.share * Fy0(t, alpha);
}

template <typename Scalar>
TyreForces<Scalar> MagicFormulaTyre<Scalar>::combined(const Scalar& load, const Scalar& kappa, const Scalar& alpha,
                                                      const Scalar& gamma) const {
  const Terms t = at(load, gamma);
  TyreForces<Scalar> out;
  switch (combined_slip) {
    case CombinedSlip::kWeighting:
      out = weighted(t, kappa, alpha);
      break;
    case CombinedSlip::kEquivalentSlip:
      out = shared(t, kappa, alpha);
      break;
    case CombinedSlip::kNone:
      out = {Fx0(t, kappa), Fy0(t, alpha)};
      break;
  }
  return {t.share * out.Fx, t.share * out.Fy};
}

template <typename Scalar>
TyreForces<Scalar> MagicFormulaTyre<Scalar>::forces(const Scalar& load, const Scalar& slip_ratio,
                                                    const Scalar& slip_angle, const Scalar& camber) const {
  using magic_formula::clamped;
  const Scalar side(mirrored ? -1.0 : 1.0);
  TyreForces<Scalar> out = combined(load, clamped(slip_ratio, range.slip_ratio_min, range.slip_ratio_max),
                                    clamped(Scalar(-side * slip_angle), range.slip_angle_min, range.slip_angle_max),
                                    clamped(Scalar(side * camber), range.camber_min, range.camber_max));
  out.Fy = side * out.Fy;
  return out;
}

template <typename Scalar>
Scalar MagicFormulaTyre<Scalar>::cornering_stiffness(const Scalar& load) const {
  using std::atan;
  using std::cos;
  const Terms t = at(load, Scalar(0.0));
  const Scalar C = coefficients.PCY1 * coefficients.LCY;
  const Scalar D = t.mu_y * t.Fz;
  const Scalar B = t.K_y / (C * D);
  const Scalar E = curvature_y(t, t.SH_y);
  const Scalar y = B * t.SH_y;
  const Scalar bent = y - E * (y - atan(y));
  const Scalar slope = (1.0 - E + E / (1.0 + y * y)) / (1.0 + bent * bent);
  return -t.share * t.K_y * slope * cos(magic_formula::angle(C, E, y));
}

template <typename Scalar>
MagicFormulaTyre<Scalar> MagicFormulaTyre<Scalar>::symmetric() const {
  MagicFormulaTyre out = *this;
  MagicFormulaCoefficients<Scalar>& c = out.coefficients;
  const Scalar none(0.0);
  c.PHX1 = c.PHX2 = c.PVX1 = c.PVX2 = none;
  c.PHY1 = c.PHY2 = c.PVY1 = c.PVY2 = c.PEY3 = none;
  c.RHX1 = c.RBY3 = c.RVY1 = c.RVY2 = none;
  c.QHZ1 = c.QHZ2 = c.QDZ3 = c.QDZ6 = c.QDZ7 = c.QEZ4 = c.QBZ4 = c.SSZ1 = none;
  return out;
}

template <typename Tyre>
class FourTyres;
/// Declared wherever the tyre is known, so that the general one is never taken for it: see four_magic_formula.hpp.
template <>
class FourTyres<MagicFormulaTyre<double>>;

}  // namespace veridyn::vehicle
