#include "veridyn/vehicle/tyre/four_magic_formula.hpp"

#include <algorithm>
#include <cstring>

#include "veridyn/vehicle/tyre/lanes.hpp"

namespace veridyn::vehicle {

FourTyres<MagicFormulaTyre<double>>::FourTyres(const PerWheel<MagicFormulaTyre<double>>& tyres) : tyres_(tyres), c_{} {
  const CombinedSlip shared = tyres[0].combined_slip;
  together_ = shared != CombinedSlip::kWeighting;
  for (std::size_t i = 0; i < kWheels; ++i) {
    const MagicFormulaTyre<double>& t = tyres[i];
    const MagicFormulaCoefficients<double>& k = t.coefficients;
    together_ = together_ && t.combined_slip == shared;
    stiffens_ = stiffens_ || k.PKX3 != 0.0;
    const std::size_t j = i + kWheels;
    const auto set = [&](Pairs& pairs, double x, double y) { pairs[i] = x, pairs[j] = y; };
    // With their scaling factors.
    set(c_.mu, k.PDX1 * k.LMUX, k.PDY1 * k.LMUY), set(c_.mu_load, k.PDX2 * k.LMUX, k.PDY2 * k.LMUY);
    set(c_.mu_camber, k.PDX3, k.PDY3);
    set(c_.SH, k.PHX1 * k.LHX, k.PHY1 * k.LHY), set(c_.SH_load, k.PHX2 * k.LHX, k.PHY2 * k.LHY);
    set(c_.SH_camber, 0.0, k.PHY3);
    set(c_.SV, k.PVX1 * k.LVX * k.LMUX, k.PVY1 * k.LVY * k.LMUY);
    set(c_.SV_load, k.PVX2 * k.LVX * k.LMUX, k.PVY2 * k.LVY * k.LMUY);
    set(c_.SV_camber, 0.0, k.PVY3 * k.LMUY), set(c_.SV_both, 0.0, k.PVY4 * k.LMUY);
    set(c_.E, k.PEX1 * k.LEX, k.PEY1 * k.LEY), set(c_.E_load, k.PEX2 * k.LEX, k.PEY2 * k.LEY);
    set(c_.E_load2, k.PEX3 * k.LEX, 0.0), set(c_.E_sign, k.PEX4, k.PEY3), set(c_.E_camber, 0.0, k.PEY4);
    set(c_.C, k.PCX1 * k.LCX, k.PCY1 * k.LCY), set(c_.per_C, 1.0 / (k.PCX1 * k.LCX), 1.0 / (k.PCY1 * k.LCY));
    set(c_.camber, k.LGAX, k.LGAY);
    const double nominal = k.FNOMIN * k.LFZO, lowest = std::max(0.01 * nominal, t.range.load_min);
    c_.K_x[i] = k.PKX1 * k.LKX, c_.K_x_load[i] = k.PKX2 * k.LKX, c_.K_x_exponent[i] = k.PKX3;
    c_.K_y[i] = k.PKY1 * nominal * k.LKY, c_.K_y_load[i] = 1.0 / (nominal * k.PKY2), c_.K_y_camber[i] = k.PKY3;
    c_.side[i] = t.mirrored ? -1.0 : 1.0;
    c_.per_nominal[i] = 1.0 / nominal;
    c_.lowest[i] = lowest, c_.per_lowest[i] = 1.0 / lowest, c_.highest[i] = t.range.load_max;
    c_.kappa_min[i] = t.range.slip_ratio_min, c_.kappa_max[i] = t.range.slip_ratio_max;
    c_.alpha_min[i] = t.range.slip_angle_min, c_.alpha_max[i] = t.range.slip_angle_max;
    c_.gamma_min[i] = t.range.camber_min, c_.gamma_max[i] = t.range.camber_max;
  }
}

VERIDYN_WIDE void FourTyres<MagicFormulaTyre<double>>::forces(const WheelArray<double>& load_of,
                                                              const WheelArray<double>& ratio_of,
                                                              const WheelArray<double>& angle_of, const double& camber,
                                                              WheelArray<double>& Fx, WheelArray<double>& Fy) const {
  using namespace in_lanes;
  if (!together_) {
    for (std::size_t i = 0; i < kWheels; ++i) {
      const TyreForces<double> f = tyres_[i].forces(load_of[i], ratio_of[i], angle_of[i], camber);
      Fx[i] = f.Fx;
      Fy[i] = f.Fy;
    }
    return;
  }
  const auto four = [](const Lanes& lanes) __attribute__((always_inline)) { return from(lanes.data()); };
  const auto both = [](const Pairs& pairs) __attribute__((always_inline)) {
    return Both{from(pairs.data()), from(pairs.data() + kWheels)};
  };
  const Coefficients& k = c_;
  const Four side = four(k.side);
  const Four kappa = clamped(from_halves(ratio_of.data()), four(k.kappa_min), four(k.kappa_max));
  const Four alpha = clamped(-side * from_halves(angle_of.data()), four(k.alpha_min), four(k.alpha_max));
  const Both gamma = both(k.camber) * clamped(side * camber, four(k.gamma_min), four(k.gamma_max));

  // What load and camber decide, see MagicFormulaTyre::at.
  const Four load = from_halves(load_of.data()), lowest = four(k.lowest);
  const Four share = load < lowest ? larger(load, Four{}) * four(k.per_lowest) : all(1.0);
  const Four Fz = clamped(load, lowest, four(k.highest)), dfz = Fz * four(k.per_nominal) - 1.0;
  const Both D = (both(k.mu) + both(k.mu_load) * dfz) * (1.0 - both(k.mu_camber) * gamma * gamma) * Fz;
  const Both SH = both(k.SH) + both(k.SH_load) * dfz + both(k.SH_camber) * gamma;
  const Both SV = ((both(k.SV) + both(k.SV_load) * dfz) + (both(k.SV_camber) + both(k.SV_both) * dfz) * gamma) * Fz;
  const Both E = both(k.E) + (both(k.E_load) + both(k.E_load2) * dfz) * dfz;
  const Both E_sign = both(k.E_sign) + both(k.E_camber) * gamma;
  Four K_x = Fz * larger(four(k.K_x) + four(k.K_x_load) * dfz, 0.1 * four(k.K_x));
  if (stiffens_) K_x *= exponential(four(k.K_x_exponent) * dfz);
  const Four x = Fz * four(k.K_y_load);
  const Four K_y = four(k.K_y) * (2.0 * x / (1.0 + x * x)) * (1.0 - four(k.K_y_camber) * size_of(gamma.y));
  // Slips count in units of friction over stiffness; along y the stiffness is negative.
  const Both per_unit = Both{K_x, K_y} / D, shift = SH * per_unit, C = both(k.C), per_C = both(k.per_C);
  const Both upward = sign_of(per_unit);

  /// The pure forces at slips in units.
  const auto pure = [&](Both slip) __attribute__((always_inline)) {
    const Both shifted = slip + shift;
    const Both bend = smaller(E * (1.0 - E_sign * (upward * sign_of(shifted))), number<Both>(1.0));
    const Both y = shifted * per_C;
    return D * sine(C * arc_tangent(y - bend * (y - arc_tangent(y)))) + SV;
  };
  const Both slip = Both{kappa, alpha} * per_unit;
  const Four squared = slip.x * slip.x + slip.y * slip.y;
  const FourBits combined = (kappa != 0.0) & (alpha != 0.0) & (squared > 0.0);
  Both force;
  if (tyres_[0].combined_slip == CombinedSlip::kNone || !any(combined)) {
    force = pure(slip);
  } else {
    const Four length = root(squared);
    const Both at_rest = pure(Both{}), at_length = pure(where({combined, combined}, sign_of(slip) * length, slip));
    const Both part = where({combined, combined}, size_of(slip) * (1.0 / length), number<Both>(1.0));
    force = at_rest + part * (at_length - at_rest);
  }
  const Four along = share * force.x, across = side * share * force.y;
  std::memcpy(Fx.data(), &along, sizeof along);
  std::memcpy(Fy.data(), &across, sizeof across);
}

}  // namespace veridyn::vehicle
