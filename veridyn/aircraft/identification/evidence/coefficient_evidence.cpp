#include "veridyn/aircraft/identification/evidence/coefficient_evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/limits.hpp"
#include "veridyn/estimation/regression/regression_evidence.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Evidence;
using estimation::Outcome;
using estimation::passed_or;
using estimation::Purpose;

/// Share of the variance that is neither modelled nor sensor noise, beyond which a prediction needs care.
constexpr double kWeakModel = 0.2;

/// Without a recommended method the answer depends on an assumption that the data refute. A method that the user fixes
/// is taken all the same.
Evidence choice_of_method(const estimation::RegressionComparison& comparison, const IdentifyOptions& options) {
  return {.name = "choice of the method",
          .outcome = passed_or(comparison.recommends, options.method_fixed() ? Outcome::kCare : Outcome::kFailed),
          .value = comparison.recommends ? 1.0 : 0.0,
          .limit = 1.0,
          .scale = "methods that may be recommended",
          .text = comparison.reason,
          .bears_on = Purpose::kParameters};
}

Evidence residual_beyond_sensors(const CoefficientChecks& checks, double limit) {
  const bool passed = checks.unmodelled_share <= limit;
  return {.name = "residual beyond the sensors",
          .outcome = passed_or(passed, Outcome::kFailed),
          .value = checks.unmodelled_share,
          .limit = limit,
          .scale = "share of the variance",
          .text = passed ? fmt::format("{:.1f} % of its variance is neither modelled nor sensor noise",
                                       100.0 * checks.unmodelled_share)
                         : unmodelled_text(checks.error_ratio, checks.unmodelled_share),
          .bears_on = Purpose::kParameters};
}

Evidence holdout(const CoefficientChecks& checks, double least_r2) {
  if (!checks.has_holdout) {
    return {.name = "hold-out",
            .outcome = Outcome::kMissing,
            .value = std::nan(""),
            .limit = least_r2,
            .scale = "R2",
            .text = "there was no hold-out to validate it on, so prediction is not judged",
            .bears_on = Purpose::kPrediction,
            .advice = "fly the manoeuvres at least twice, so that some of them can be held out"};
  }
  const bool passed = checks.holdout_fit.r2 >= least_r2;
  const bool weak = checks.unmodelled_share > kWeakModel;
  const double explained = 100.0 * std::max(0.0, checks.holdout_fit.r2);
  if (!passed && checks.holdout_ratio < estimation::kNoiseKnownTo) {
    // A coefficient that hardly varies, such as drag in cruise: its parameters have their intervals all the same.
    return {
        .name = "hold-out",
        .outcome = Outcome::kCare,
        .value = checks.holdout_fit.r2,
        .limit = least_r2,
        .scale = "R2",
        .text = fmt::format("it explains {:.0f} % of the coefficient's variance on the hold-out, and the rest is no "
                            "more than noise of the sensors: the coefficient hardly varies there",
                            explained),
        .bears_on = Purpose::kPrediction,
        .advice = "hold out manoeuvres in which the coefficient varies more"};
  }
  return {.name = "hold-out",
          .outcome = !passed ? Outcome::kFailed : passed_or(!weak, Outcome::kCare),
          .value = checks.holdout_fit.r2,
          .limit = least_r2,
          .scale = "R2",
          .text = passed ? fmt::format("it explains {:.0f} % of the hold-out", explained)
                         : fmt::format("it explains {:.0f} % of the coefficient's variance on the hold-out, less than "
                                       "{:.0f} %",
                                       explained, 100.0 * least_r2),
          .bears_on = Purpose::kParameters | Purpose::kPrediction};
}

/// Bands that do not hold on data that were held out promise too much.
Evidence bands_on_holdout(const CoefficientChecks& checks) {
  constexpr double kCare = 0.15;  // three times what is meant
  const bool passed = checks.outside_bands <= kCare;
  return {.name = "bands on the hold-out",
          .outcome = passed_or(passed, Outcome::kCare),
          .value = checks.outside_bands,
          .limit = kCare,
          .scale = "share outside 95 %",
          .text = fmt::format("{:.1f} % of the hold-out lies outside the bands of 95 %{}", 100.0 * checks.outside_bands,
                              passed ? "" : ": held-out motion is not like that of the identification"),
          .bears_on = Purpose::kPrediction,
          .advice = passed ? std::string() : std::string("identify from manoeuvres like those that are predicted")};
}

/// An estimate should predict better than what was there before, or no worse than noise makes it.
Evidence against_start(const CoefficientChecks& checks) {
  constexpr double kCare = 1.05;
  const bool passed = checks.error_over_start <= kCare;
  return {.name = "hold-out against the start values",
          .outcome = passed_or(passed, Outcome::kCare),
          .value = checks.error_over_start,
          .limit = kCare,
          .scale = "error over that of the start",
          .text = fmt::format("on the hold-out its error is {:.3g} times that of the values that the study gives{}",
                              checks.error_over_start, passed ? "" : ": these predict better"),
          .bears_on = Purpose::kPrediction,
          .advice = passed ? std::string() : std::string("keep the values of the study for simulation")};
}

Evidence parts_of_the_flight(const CoefficientChecks& checks, double level) {
  if (std::isnan(checks.contradiction_p)) {
    return {.name = "agreement of the flight's parts",
            .outcome = Outcome::kNotVerified,
            .value = checks.contradiction_p,
            .limit = level,
            .scale = "p",
            .text =
                "the hold-out by itself does not determine its parameters, so that nothing shows whether two parts "
                "of the flight agree",
            .bears_on = Purpose::kParameters,
            .advice = "hold out manoeuvres that excite all that is identified"};
  }
  const bool passed = checks.contradiction_p >= level;
  return {.name = "agreement of the flight's parts",
          .outcome = passed_or(passed, Outcome::kFailed),
          .value = checks.contradiction_p,
          .limit = level,
          .scale = "p",
          .text = passed ? fmt::format("estimates from two parts of the flight agree (p = {:.2g}){}",
                                       checks.contradiction_p,
                                       checks.scatter > 1.0 ? fmt::format("; intervals are widened by {:.2f}, as they "
                                                                          "scatter by more than their error bars",
                                                                          std::sqrt(checks.scatter))
                                                            : "")
                         : fmt::format("estimates from two parts of the flight contradict each other beyond their "
                                       "error bars (p = {:.1e})",
                                       checks.contradiction_p),
          .bears_on = Purpose::kParameters};
}

}  // namespace

std::vector<Evidence> coefficient_evidence(const std::string& name, const CoefficientChecks& checks,
                                           const estimation::RegressionComparison& comparison,
                                           const IdentifyOptions& options) {
  std::vector<Evidence> rows{choice_of_method(comparison, options),
                             residual_beyond_sensors(checks, options.max_unmodelled),
                             holdout(checks, options.min_holdout_r2)};
  if (checks.has_holdout) {
    rows.push_back(bands_on_holdout(checks));
    if (std::isfinite(checks.error_over_start)) rows.push_back(against_start(checks));
    rows.push_back(parts_of_the_flight(checks, options.contradiction_level));
  }
  if (const estimation::RegressionEstimate* examined = comparison.examined_estimate())
    rows.push_back(estimation::collinearity(*examined, checks.error_ratio < estimation::kNoiseKnownTo));
  rows.insert(rows.end(), comparison.checks.begin(), comparison.checks.end());
  for (Evidence& row : rows) row.about = name;
  return rows;
}

std::string unmodelled_text(double error_ratio, double unmodelled_share) {
  const double times = std::sqrt(std::max(0.0, error_ratio));
  if (!(error_ratio > 0.0) || !std::isfinite(times) || !std::isfinite(unmodelled_share)) {
    return "the errors of its regressors leave no signal to judge by how much of its residual is noise of the sensors";
  }
  return fmt::format(
      "{:.0f} % of its variance is neither modelled nor sensor noise (residual {:.1f} times what the sensors leave), "
      "so something that moves the aircraft is not among the regressors and biases them",
      100.0 * unmodelled_share, times);
}

Evidence scatter_row(const std::string& name, const estimation::GroupScatter& scatter,
                     const estimation::RegressionEstimate& chosen) {
  Evidence row{.name = "scatter between flights",
               .about = name,
               .value = scatter.p,
               .limit = estimation::GroupScatter::kLevel,
               .scale = "p",
               .bears_on = Purpose::kParameters};
  if (!(scatter.freedom > 0.0)) {
    row.outcome = Outcome::kNotVerified;
    row.value = std::nan("");
    row.text = fmt::format(
        "{} of {} flights determine its parameters by themselves, so that nothing shows whether "
        "these differ between flights; the intervals take them to be the same",
        scatter.compared, scatter.groups);
    row.advice = "fly every manoeuvre in at least two of the flights";
    return row;
  }
  const std::string test =
      fmt::format("Cochran's Q {:.0f} on {:.0f} degrees of freedom, p = {:.2g}", scatter.q, scatter.freedom, scatter.p);
  if (!scatter.found()) {
    row.outcome = Outcome::kPassed;
    row.text = fmt::format("{} flights have the same parameters within their error bars ({})", scatter.compared, test);
    return row;
  }
  // The relative scatter of what is not zero says most.
  std::string most;
  double largest = 0.0;
  for (std::size_t j = 0; j < chosen.parameters.size(); ++j) {
    const estimation::Parameter& p = chosen.parameters[j];
    const double share = scatter.between_sigma(j) / std::abs(p.value);
    if (p.status != estimation::ParameterStatus::kIdentified || !(share > largest)) continue;
    largest = share;
    most = fmt::format(", most in {} (standard deviation between flights {:.2g} %)", p.name, 100.0 * share);
  }
  row.outcome = Outcome::kCare;
  row.text = fmt::format(
      "the flights differ by more than their error bars{}: {}; the intervals are those of the mean of "
      "flights like these, from the scatter of {}",
      most, test, scatter.compared);
  row.advice = "find what differs between the flights, or fly more: the interval of a mean of few is wide";
  return row;
}

std::vector<estimation::Parameter> weak_by_collinearity(std::vector<estimation::Parameter> parameters,
                                                        std::span<const Evidence> rows) {
  const auto row = std::ranges::find_if(rows, estimation::is_collinearity);
  if (row == rows.end() || row->passed()) return parameters;
  for (estimation::Parameter& p : parameters)
    if (p.status == estimation::ParameterStatus::kIdentified && p.variance_inflation > estimation::kVarianceInflation)
      p.status = estimation::ParameterStatus::kWeak;
  return parameters;
}

std::vector<Evidence> plausibility(Coefficient coefficient, std::span<const estimation::Parameter> parameters,
                                   const Subject& subject) {
  /// Sign that every aircraft that flies has, and what a wrong one suggests.
  struct Expected {
    const char* parameter;
    double sign;
    const char* suspect;
  };
  static constexpr std::array<Expected, 6> kExpected{{{"CL_alpha", 1.0, "the sign of alpha or of accel_z"},
                                                      {"CD_0", 1.0, "the thrust, or the zero of accel_x"},
                                                      {"CY_beta", -1.0, "the sign of beta or of accel_y"},
                                                      {"Cl_p", -1.0, "the sign of gyro_x, or a delay"},
                                                      {"Cm_q", -1.0, "the sign of gyro_y, or a delay"},
                                                      {"Cn_r", -1.0, "the sign of gyro_z, or a delay"}}};
  constexpr double kLiftSlopeFactor = 2.0;
  std::vector<Evidence> rows;
  const auto row = [&](const estimation::Parameter& p, bool plausible, double limit, std::string text,
                       std::string advice) {
    rows.push_back({.name = fmt::format("plausibility of {}", p.name),
                    .about = p.name,
                    .outcome = passed_or(plausible, Outcome::kCare),
                    .value = p.value,
                    .limit = limit,
                    .scale = "value",
                    .text = std::move(text),
                    .bears_on = Purpose::kParameters,
                    .advice = plausible ? std::string() : std::move(advice)});
  };
  // With other terms in alpha its slope is not the parameter's.
  const bool linear_in_alpha =
      std::ranges::count_if(parameters, [](const estimation::Parameter& p) {
        return p.name.find("alpha") != std::string::npos || p.name.find('(') != std::string::npos;
      }) <= 1;
  for (const Expected& e : kExpected) {
    if (coefficient == Coefficient::kCL && !linear_in_alpha) continue;
    const estimation::Parameter* p = estimation::find_parameter(parameters, e.parameter);
    if (p == nullptr || !std::isfinite(p->sigma) || !std::isfinite(p->value)) continue;
    const bool plausible = !(-e.sign * p->value > estimation::kBeyondChance * p->sigma);
    row(*p, plausible, 0.0,
        plausible ? fmt::format("{} has the sign that an aircraft has", p->name)
                  : fmt::format("{} is {:.3g} +- {:.2g}, but every aircraft has it {}", p->name, p->value, p->sigma,
                                e.sign > 0.0 ? "positive" : "negative"),
        fmt::format("check {}", e.suspect));
  }
  const estimation::Parameter* slope = estimation::find_parameter(parameters, "CL_alpha");
  if (slope != nullptr && linear_in_alpha && std::isfinite(slope->sigma) && slope->value > 0.0) {
    const double aspect_ratio = subject.span * subject.span / subject.wing_area;
    const double theory = 2.0 * kPi * aspect_ratio / (2.0 + std::sqrt(4.0 + aspect_ratio * aspect_ratio));
    const double low = theory / kLiftSlopeFactor - estimation::kBeyondChance * slope->sigma;
    const double high = theory * kLiftSlopeFactor + estimation::kBeyondChance * slope->sigma;
    const bool plausible = slope->value >= low && slope->value <= high;
    row(*slope, plausible, theory,
        fmt::format("the lift slope is {:.3g} per rad, lifting-line theory of a wing of aspect ratio {:.3g} gives "
                    "{:.3g}{}",
                    slope->value, aspect_ratio, theory, plausible ? "" : ": too far off for a wing like this"),
        "check unit and scale of alpha, of accel_z and of the airspeed, the mass and the wing area");
  }
  return rows;
}

}  // namespace veridyn::aircraft
