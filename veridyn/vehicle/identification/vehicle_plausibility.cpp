#include "veridyn/vehicle/identification/vehicle_plausibility.hpp"

#include <fmt/format.h>

#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Evidence;
using estimation::Outcome;
using estimation::Parameter;
using estimation::ParameterStatus;
using estimation::Purpose;

constexpr double kStandardErrors = 3.0;

/// What vehicles have, and what none has.
struct Range {
  double low, high, impossibly_low, impossibly_high;
};

Outcome outcome_of(double ratio, double sigma, const Range& range) {
  const double low = ratio + kStandardErrors * sigma, high = ratio - kStandardErrors * sigma;
  if (low < range.impossibly_low || high > range.impossibly_high) return Outcome::kFailed;
  return low < range.low || high > range.high ? Outcome::kCare : Outcome::kPassed;
}

/// A parameter over what it would be in an ordinary vehicle; nothing where it was not determined.
void add_ratio(std::vector<Evidence>& rows, std::span<const Parameter> parameters, const char* name, double ordinary,
               const char* ordinary_text, const Range& range, const char* advice) {
  const Parameter* p = estimation::find_parameter(parameters, name);
  if (p == nullptr || p->status == ParameterStatus::kNotExcited || p->status == ParameterStatus::kFixed) return;
  if (!std::isfinite(p->value) || !std::isfinite(p->sigma) || !(ordinary > 0.0)) return;
  const double ratio = p->value / ordinary;
  const Outcome outcome = outcome_of(ratio, p->sigma / ordinary, range);
  rows.push_back(
      {.name = fmt::format("plausibility of {}", name),
       .about = name,
       .outcome = outcome,
       .value = ratio,
       .limit = ratio < 1.0 ? range.low : range.high,
       .scale = ordinary_text,
       .text = fmt::format(
           "{} is {:.3g} times {}{}", name, ratio, ordinary_text,
           outcome == Outcome::kPassed ? "" : fmt::format(", where vehicles have {:g} to {:g}", range.low, range.high)),
       .bears_on = Purpose::kParameters,
       .advice = outcome == Outcome::kPassed ? "" : advice});
}

}  // namespace

std::vector<Evidence> plausibility(std::span<const Parameter> parameters, const VehicleParameters<double>& known) {
  std::vector<Evidence> rows;
  const double weight = known.mass * kGravity, L = known.a + known.b;
  const char* const units = "check mass, a and b, the steering ratio, and units and signs of the channels";
  add_ratio(rows, parameters, "I_z", known.mass * known.a * known.b, "m a b", {0.5, 2.0, 0.2, 5.0}, units);
  constexpr Range kStiffness{4.0, 40.0, 1.0, 120.0};
  add_ratio(rows, parameters, "C_f", 0.5 * weight * known.b / L, "the static wheel load per rad", kStiffness, units);
  add_ratio(rows, parameters, "C_r", 0.5 * weight * known.a / L, "the static wheel load per rad", kStiffness, units);
  add_ratio(rows, parameters, "mu", 1.0, "1", {0.05, 1.6, 0.0, 3.0},
            "drive nearer to the limit of grip, or take linear tyres");
  for (const Parameter& p : parameters) {
    constexpr double kRounding = 1e-12;
    if (p.status == ParameterStatus::kFixed || p.status == ParameterStatus::kNotExcited) continue;
    if (!(p.sigma <= kRounding * std::abs(p.value)) || p.value == 0.0) continue;
    rows.push_back(
        {.name = fmt::format("standard error of {}", p.name),
         .about = p.name,
         .outcome = Outcome::kFailed,
         .value = p.sigma,
         .limit = kRounding * std::abs(p.value),
         .scale = p.unit,
         .text = fmt::format("the standard error of {} is zero to rounding: its search ended at a bound", p.name),
         .bears_on = Purpose::kParameters,
         .advice = fmt::format("leave {} out of identify.estimate", p.name)});
  }
  return rows;
}

}  // namespace veridyn::vehicle
