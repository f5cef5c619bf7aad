#include "veridyn/aircraft/export/handbook.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

constexpr double kVolumeH = 0.5, kVolumeV = 0.04;                            // Raymer 2018, table 6.4, homebuilt
constexpr double kSlopeH = 4.0, kSlopeV = 3.0;                               // tails of aspect ratio 4 and 2
constexpr double kEffectiveness = 0.5, kAileronEffectiveness = 0.4;          // of 30 and 20 % of the chord
constexpr double kStaticMargin = 0.1, kDihedral = 3.0 * kDegree;             // ours
constexpr double kSkinFriction = 0.0055, kWettedArea = 4.5, kTailArm = 3.0;  // Raymer 2018, table 12.3; ours
constexpr double kAileronSpan = (0.95 * 0.95 - 0.5 * 0.5) / 4.0;             // ours

constexpr std::string_view kDatcom = "DATCOM 4.1.3.2, straight wing of this aspect ratio";
constexpr std::string_view kDrag = "Raymer 2018, table 12.3 and eq. 12.48, skin friction and induced drag";
constexpr std::string_view kTail = "Nelson 1998, tail of volume 0.5 and arm 3 c";
constexpr std::string_view kFin = "Nelson 1998, fin of volume 0.04 and arm 3 c";
constexpr std::string_view kStrips = "Nelson 1998, strips of a rectangular wing";
constexpr std::string_view kMargin = "static margin of 10 % of the chord";

/// Span efficiency of a straight wing; the formula ends at slender ones.
double span_efficiency(double A) { return std::clamp(1.78 * (1.0 - 0.045 * std::pow(A, 0.68)) - 0.64, 0.7, 0.95); }

/// Value and source of a derivative by its name.
struct Named {
  std::string_view name;
  double value;
  std::string_view source;
};

}  // namespace

std::vector<Term> handbook_terms(Coefficient coefficient) {
  const auto terms = [](std::initializer_list<const char*> texts) {
    std::vector<Term> parsed;
    for (const char* text : texts) parsed.push_back(parse_term(text, "handbook"));
    return parsed;
  };
  switch (coefficient) {
    case Coefficient::kCL:
      return terms({"1", "alpha", "q_n", "de"});
    case Coefficient::kCD:
      return terms({"1", "alpha", "alpha^2"});
    case Coefficient::kCY:
      return terms({"beta", "r_n", "dr"});
    case Coefficient::kCl:
      return terms({"beta", "p_n", "r_n", "da"});
    case Coefficient::kCm:
      return terms({"1", "alpha", "q_n", "de"});
    case Coefficient::kCn:
      return terms({"beta", "p_n", "r_n", "dr"});
  }
  return {};
}

std::optional<HandbookValue> handbook_value(const Subject& s, const HandbookFlight& flight, const SurfaceSigns& signs,
                                            Coefficient coefficient, const Term& term) {
  const double A = s.aspect_ratio(), k = 1.0 / (kPi * A * span_efficiency(A));
  const double slope = flight.CL_alpha, CL_0 = flight.CL - slope * flight.alpha;
  const double tail = kSlopeH * kVolumeH, fin = kSlopeV * kVolumeV;
  const double arm = kTailArm * s.chord / s.span;  // of the fin, in spans
  const double Cm_alpha = -kStaticMargin * slope;
  const Named table[] = {
      {"CL_0", 0.0, "alpha counted from the direction of no lift"},
      {"CL_alpha", kFullTurn * A / (2.0 + std::sqrt(4.0 + A * A)), kDatcom},
      {"CL_q", 2.0 * tail, kTail},
      {"CL_de", signs.elevator * kEffectiveness * tail / kTailArm, kTail},
      {"CD_0", kSkinFriction * kWettedArea + k * CL_0 * CL_0, kDrag},
      {"CD_alpha", 2.0 * k * CL_0 * slope, kDrag},
      {"CD_alpha2", k * slope * slope, kDrag},
      {"CY_beta", -fin / arm, kFin},
      {"CY_r", 2.0 * fin, kFin},
      {"CY_dr", signs.rudder * kEffectiveness * fin / arm, kFin},
      {"Cl_beta", -slope * kDihedral / 4.0, "Nelson 1998, dihedral of 3 deg"},
      {"Cl_p", -slope / 6.0, kStrips},
      {"Cl_r", flight.CL / 4.0, kStrips},
      {"Cl_da", -signs.aileron * kAileronEffectiveness * slope * kAileronSpan, kStrips},
      {"Cm_0", -Cm_alpha * flight.alpha, "level flight without elevator"},
      {"Cm_alpha", Cm_alpha, kMargin},
      {"Cm_q", -2.0 * tail * kTailArm, kTail},
      {"Cm_de", -signs.elevator * kEffectiveness * tail, kTail},
      {"Cn_beta", fin, kFin},
      {"Cn_p", -flight.CL / 8.0, kStrips},
      {"Cn_r", -2.0 * fin * arm, kFin},
      {"Cn_dr", -signs.rudder * kEffectiveness * fin, kFin},
  };
  const std::string name = parameter_name(coefficient, term);
  for (const Named& row : table)
    if (row.name == name) return HandbookValue{row.value + 0.0, std::string(row.source)};
  return std::nullopt;
}

Inertia handbook_inertia(const Subject& s) {
  const double length = 0.75 * s.span;
  const auto moment = [&](double extent, double radius) { return s.mass * std::pow(0.5 * extent * radius, 2); };
  return {.Jx = moment(s.span, 0.25), .Jy = moment(length, 0.38), .Jz = moment(0.5 * (s.span + length), 0.39)};
}

}  // namespace veridyn::aircraft
