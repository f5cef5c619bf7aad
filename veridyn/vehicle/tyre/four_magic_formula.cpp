#include "veridyn/vehicle/tyre/four_magic_formula.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "veridyn/numerics/trigonometry.hpp"

// Vectors of four doubles are passed between functions of this file only, all of them inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

// Wider registers where the processor has them; without fused multiplication, so that results are the same.
#if defined(__x86_64__) && !defined(__clang__)
#define VERIDYN_WIDE [[gnu::target_clones("avx2", "default")]]
#else
#define VERIDYN_WIDE
#endif

namespace veridyn::vehicle {
namespace in_lanes {
namespace {

using Four = double __attribute__((vector_size(32)));
using FourBits = long long __attribute__((vector_size(32)));

[[gnu::always_inline]] inline Four from(const double* numbers) {
  Four x;
  std::memcpy(&x, numbers, sizeof x);
  return x;
}
[[gnu::always_inline]] inline Four all(double x) { return Four{} + x; }
[[gnu::always_inline]] inline Four larger(Four a, Four b) { return a > b ? a : b; }
[[gnu::always_inline]] inline Four smaller(Four a, Four b) { return a < b ? a : b; }
[[gnu::always_inline]] inline Four clamped(Four x, Four lowest, Four highest) {
  return smaller(larger(x, lowest), highest);
}
[[gnu::always_inline]] inline Four size_of(Four x) { return x < 0.0 ? -x : x; }
[[gnu::always_inline]] inline Four sign_of(Four x) { return x < 0.0 ? all(-1.0) : all(1.0); }
[[gnu::always_inline]] inline Four root(Four x) {
  return Four{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}
[[gnu::always_inline]] inline FourBits bits_of(Four x) {
  FourBits bits;
  std::memcpy(&bits, &x, sizeof x);
  return bits;
}
/// Added to a number, rounds it and leaves the whole number in its last bits: 1.5 2^52.
constexpr double kRounds = 6755399441055744.0;

/// Both directions of four tyres: two chains of operations, side by side, which the processor overlaps.
struct Both {
  Four x, y;
};
struct BothBits {
  FourBits x, y;
};
[[gnu::always_inline]] inline Both operator+(Both a, Both b) { return {a.x + b.x, a.y + b.y}; }
[[gnu::always_inline]] inline Both operator-(Both a, Both b) { return {a.x - b.x, a.y - b.y}; }
[[gnu::always_inline]] inline Both operator*(Both a, Both b) { return {a.x * b.x, a.y * b.y}; }
[[gnu::always_inline]] inline Both operator/(Both a, Both b) { return {a.x / b.x, a.y / b.y}; }
[[gnu::always_inline]] inline Both operator*(Both a, Four b) { return {a.x * b, a.y * b}; }
[[gnu::always_inline]] inline Both operator+(double a, Both b) { return {a + b.x, a + b.y}; }
[[gnu::always_inline]] inline Both operator-(double a, Both b) { return {a - b.x, a - b.y}; }
[[gnu::always_inline]] inline Both operator*(double a, Both b) { return {a * b.x, a * b.y}; }
[[gnu::always_inline]] inline Both all_of_both(double x) { return {all(x), all(x)}; }
[[gnu::always_inline]] inline Both size_of(Both a) { return {size_of(a.x), size_of(a.y)}; }
[[gnu::always_inline]] inline Both sign_of(Both a) { return {sign_of(a.x), sign_of(a.y)}; }
[[gnu::always_inline]] inline Both smaller(Both a, Both b) { return {smaller(a.x, b.x), smaller(a.y, b.y)}; }
[[gnu::always_inline]] inline BothBits at_most(Both a, double b) { return {a.x <= b, a.y <= b}; }
[[gnu::always_inline]] inline Both where(BothBits is, Both then, Both other) {
  return {is.x ? then.x : other.x, is.y ? then.y : other.y};
}
[[gnu::always_inline]] inline Both with_sign_of(Both a, Both b) {
  return {b.x < 0.0 ? -a.x : a.x, b.y < 0.0 ? -a.y : a.y};
}

/// As `arc_tangents`, for any argument: atan(x) = atan(c) + atan((x - c)/(1 + c x)) with a c that leaves at most 0.35.
[[gnu::always_inline]] inline Both arc_tangent(Both x) {
  constexpr double kNear = 0.75, kFar = 2.2;
  constexpr double kAngleOfNear = 0.6435011087932844, kAngleOfFar = 1.1441688336680205;
  const auto number = [](double v) __attribute__((always_inline)) { return all_of_both(v); };
  const Both a = size_of(x);
  const BothBits small = at_most(a, 0.35), near = at_most(a, 1.1), far = at_most(a, 9.0);
  const Both centre = where(small, number(0.0), where(near, number(kNear), number(kFar)));
  const Both base =
      where(small, number(0.0), where(near, number(kAngleOfNear), where(far, number(kAngleOfFar), number(kPi / 2.0))));
  const Both y = where(far, a - centre, number(-1.0)) / where(far, 1.0 + centre * a, a);
  const auto& c = numerics::internal::kArcTangent;
  const Both z = y * y, z2 = z * z, z4 = z2 * z2;
  const Both low = (c[0] + c[1] * z) + z2 * (c[2] + c[3] * z);
  const Both high = (c[4] + c[5] * z) + z2 * (c[6] + c[7] * z) + z4 * (c[8] + c[9] * z);
  return with_sign_of(base + (y + (y * z) * (low + z4 * high)), x);
}

/// As `sine_cosine`, up to 1e5 rad.
[[gnu::always_inline]] inline Both sine(Both x) {
  const Both rounded = kRounds + 0.63661977236758134 * x, k = rounded - all_of_both(kRounds);
  const FourBits quarter_x = bits_of(rounded.x), quarter_y = bits_of(rounded.y);
  const Both y = ((x - 1.5707963267341256 * k) - 6.077100506303966e-11 * k) - 2.0222662487959506e-21 * k;
  const Both z = y * y, z2 = z * z, z4 = z2 * z2;
  const auto& a = numerics::internal::kSine;
  const auto& b = numerics::internal::kCosine;
  const Both s = y + (y * z) * ((a[0] + a[1] * z) + z2 * (a[2] + a[3] * z) + z4 * (a[4] + a[5] * z));
  const Both c = (1.0 - 0.5 * z) + z2 * ((b[0] + b[1] * z) + z2 * (b[2] + b[3] * z) + z4 * (b[4] + b[5] * z));
  const Both value = where({(quarter_x & 1) != 0, (quarter_y & 1) != 0}, c, s);
  return where({(quarter_x & 2) != 0, (quarter_y & 2) != 0}, Both{} - value, value);
}

/// e^x, up to 700: 2^k times the power series of what is left, at most half of ln 2, which is in two parts.
[[gnu::always_inline]] inline Four exponential(Four x) {
  const Four rounded = clamped(x, all(-700.0), all(700.0)) * 1.4426950408889634 + kRounds;
  const Four k = rounded - kRounds;
  const Four r = (x - k * 0.693147180369123816490) - k * 1.90821492927058770002e-10;
  constexpr std::array<double, 14> c = [] {
    std::array<double, 14> of{1.0};
    for (std::size_t n = 1; n < of.size(); ++n) of[n] = of[n - 1] / static_cast<double>(n);
    return of;
  }();
  const Four r2 = r * r, r4 = r2 * r2;
  const Four low = (c[0] + c[1] * r) + r2 * (c[2] + c[3] * r), middle = (c[4] + c[5] * r) + r2 * (c[6] + c[7] * r);
  const Four high = (c[8] + c[9] * r) + r2 * (c[10] + c[11] * r) + r4 * (c[12] + c[13] * r);
  const Four sum = low + r4 * (middle + r4 * high);
  constexpr int kMantissa = 52;
  const auto power = (bits_of(rounded) << kMantissa) + bits_of(all(1.0));
  Four scale;
  std::memcpy(&scale, &power, sizeof scale);
  return sum * scale;
}

}  // namespace
}  // namespace in_lanes

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
      const auto w = static_cast<Eigen::Index>(i);
      const TyreForces<double> f = tyres_[i].forces(load_of[w], ratio_of[w], angle_of[w], camber);
      Fx[w] = f.Fx;
      Fy[w] = f.Fy;
    }
    return;
  }
  const auto four = [](const Lanes& lanes) __attribute__((always_inline)) { return from(lanes.data()); };
  const auto both = [](const Pairs& pairs) __attribute__((always_inline)) {
    return Both{from(pairs.data()), from(pairs.data() + kWheels)};
  };
  const Coefficients& k = c_;
  const Four side = four(k.side);
  const Four kappa = clamped(from(ratio_of.data()), four(k.kappa_min), four(k.kappa_max));
  const Four alpha = clamped(-side * from(angle_of.data()), four(k.alpha_min), four(k.alpha_max));
  const Both gamma = both(k.camber) * clamped(side * camber, four(k.gamma_min), four(k.gamma_max));

  // What load and camber decide, see MagicFormulaTyre::at.
  const Four load = from(load_of.data()), lowest = four(k.lowest);
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
    const Both bend = smaller(E * (1.0 - E_sign * (upward * sign_of(shifted))), all_of_both(1.0));
    const Both y = shifted * per_C;
    return D * sine(C * arc_tangent(y - bend * (y - arc_tangent(y)))) + SV;
  };
  const Both slip = Both{kappa, alpha} * per_unit;
  const Four squared = slip.x * slip.x + slip.y * slip.y;
  const FourBits combined = (kappa != 0.0) & (alpha != 0.0) & (squared > 0.0);
  const bool any = (combined[0] | combined[1] | combined[2] | combined[3]) != 0;
  Both force;
  if (tyres_[0].combined_slip == CombinedSlip::kNone || !any) {
    force = pure(slip);
  } else {
    const Four length = root(squared);
    const Both at_rest = pure(Both{}), at_length = pure(where({combined, combined}, sign_of(slip) * length, slip));
    const Both part = where({combined, combined}, size_of(slip) * (1.0 / length), all_of_both(1.0));
    force = at_rest + part * (at_length - at_rest);
  }
  const Four along = share * force.x, across = side * share * force.y;
  std::memcpy(Fx.data(), &along, sizeof along);
  std::memcpy(Fy.data(), &across, sizeof across);
}

}  // namespace veridyn::vehicle
