#include "veridyn/vehicle/identification/evidence/vehicle_plausibility.hpp"

#include <fmt/format.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/deg_per_g.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Evidence;
using estimation::Outcome;
using estimation::Parameter;
using estimation::ParameterStatus;
using estimation::Purpose;

/// A parameter over what it would be in an ordinary vehicle; nothing where it was not determined.
void add_ratio(std::vector<Evidence>& rows, std::span<const Parameter> parameters, const char* name, double ordinary,
               const char* ordinary_text, const estimation::Tolerance& range, const char* advice) {
  const Parameter* p = estimation::find_parameter(parameters, name);
  if (p == nullptr || p->status == ParameterStatus::kNotExcited || p->status == ParameterStatus::kFixed) return;
  if (!std::isfinite(p->value) || !std::isfinite(p->sigma) || !(ordinary > 0.0)) return;
  const double ratio = p->value / ordinary;
  const Outcome outcome = estimation::outcome_of(ratio, p->sigma / ordinary, range);
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
  constexpr estimation::Tolerance kStiffness{4.0, 40.0, 1.0, 120.0};
  add_ratio(rows, parameters, "C_f", 0.5 * weight * known.b / L, "the static wheel load per rad", kStiffness, units);
  add_ratio(rows, parameters, "C_r", 0.5 * weight * known.a / L, "the static wheel load per rad", kStiffness, units);
  add_ratio(rows, parameters, "mu", 1.0, "1", {0.05, 1.6, 0.0, 3.0},
            "drive nearer to the limit of grip, or take linear tyres");
  // As an angle per g it does not depend on the vehicle's size.
  const Parameter* K = estimation::find_parameter(parameters, "understeer_gradient");
  if (K != nullptr && K->status != ParameterStatus::kNotExcited && std::isfinite(K->sigma) && L > 0.0) {
    constexpr estimation::Tolerance kUndersteer{-0.05, 0.2, -0.3, 1.0};
    const double per_g = K->value * kGravity;
    const Outcome outcome = estimation::outcome_of(per_g, K->sigma * kGravity, kUndersteer);
    rows.push_back({.name = "plausibility of understeer_gradient",
                    .about = "understeer_gradient",
                    .outcome = outcome,
                    .value = per_g,
                    .limit = per_g < 0.0 ? kUndersteer.low : kUndersteer.high,
                    .scale = "rad per g",
                    .text = fmt::format("the understeer is {:.1f} deg/g{}", deg_per_g(K->value),
                                        outcome == Outcome::kPassed ? "" : ", where vehicles have -3 to 11"),
                    .bears_on = Purpose::kParameters,
                    .advice = outcome == Outcome::kPassed ? "" : units});
  }
  return rows;
}

std::vector<Evidence> bound_rows(std::span<const Parameter> parameters) {
  std::vector<Evidence> rows;
  for (const Parameter& p : parameters) {
    constexpr double kNoError = 1e-12;  // a share of the value
    if (p.status == ParameterStatus::kFixed || p.status == ParameterStatus::kNotExcited) continue;
    const bool at_bound = p.status == ParameterStatus::kAtBound;
    if (!at_bound && (!(p.sigma <= kNoError * std::abs(p.value)) || p.value == 0.0)) continue;
    rows.push_back(
        {.name = fmt::format("bound of {}", p.name),
         .about = p.name,
         .outcome = Outcome::kFailed,
         .value = at_bound ? p.value : p.sigma,
         .limit = at_bound ? p.value : kNoError * std::abs(p.value),
         .scale = p.unit,
         .text = at_bound
                     ? fmt::format("the search for {} ended at {:.3g}, the limit of what it may be", p.name, p.value)
                     : fmt::format("the standard error of {} is zero to rounding: its search ended at a bound", p.name),
         .bears_on = Purpose::kParameters,
         .advice = fmt::format("leave {} out of identify.estimate", p.name)});
  }
  return rows;
}

}  // namespace veridyn::vehicle
