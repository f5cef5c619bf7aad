#include "veridyn/aircraft/identification/evidence/coefficient_evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/judgement/limits.hpp"
#include "veridyn/estimation/regression/regression_evidence.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::Outcome;
using estimation::passed_or;
using estimation::Purpose;
using estimation::Purposes;
using estimation::row_of;

/// Share of the variance that is neither modelled nor sensor noise, beyond which a prediction needs care.
constexpr double kWeakModel = 0.2;

/// A row with its value against a limit that the study may set, or a test's level.
Evidence against(Check check, const std::string& about, Outcome outcome, double value, double limit) {
  Evidence row = row_of(check, about, outcome);
  row.value = value;
  row.limit = limit;
  return row;
}

/// Without a recommended method the answer depends on an assumption that the data refute. A method that the user fixes
/// is taken all the same.
Evidence choice_of_method(const std::string& name, const estimation::RegressionComparison& comparison,
                          const IdentifyOptions& options) {
  return against(Check::kMethodChoice, name,
                 passed_or(comparison.recommends, options.method_fixed() ? Outcome::kCare : Outcome::kFailed),
                 comparison.recommends ? 1.0 : 0.0, 1.0)
      .with("reason", comparison.reason);
}

Evidence residual_beyond_sensors(const std::string& name, const CoefficientChecks& checks, double limit) {
  const bool passed = checks.unmodelled_share <= limit;
  Evidence row =
      against(Check::kUnmodelledCoefficient, name, passed_or(passed, Outcome::kFailed), checks.unmodelled_share, limit);
  // Without a ratio the errors of the regressors leave no signal to judge by.
  const bool known = checks.error_ratio > 0.0 && std::isfinite(checks.error_ratio) && std::isfinite(row.value);
  if (!passed) row.cause = known ? Cause::kMissingTerm : Cause::kNoise;
  return std::move(row).with("times", std::sqrt(std::max(0.0, checks.error_ratio)));
}

Evidence holdout(const std::string& name, const CoefficientChecks& checks, double least_r2) {
  const double r2 = checks.holdout_fit.r2;
  const auto row = [&](Outcome outcome, Purposes bears_on, Cause cause) {
    Evidence made = against(Check::kCoefficientHoldOut, name, outcome, checks.has_holdout ? r2 : kNaN, least_r2);
    made.bears_on = bears_on;
    made.cause = cause;
    return std::move(made).with("explained", std::max(0.0, r2));
  };
  if (!checks.has_holdout) return row(Outcome::kMissing, Purpose::kPrediction, Cause::kMissing);
  const bool passed = r2 >= least_r2;
  // A coefficient that hardly varies, such as drag in cruise: its parameters have their intervals all the same. One
  // that misses by more than the mean does is not that.
  const bool noise_alone = checks.holdout_ratio < estimation::kNoiseKnownTo && !(r2 < 0.0);
  if (!passed && noise_alone) return row(Outcome::kCare, Purpose::kPrediction, Cause::kExcitation);
  if (estimation::outcome_of_hold_out(r2, least_r2) == Outcome::kCare && !noise_alone)
    return row(Outcome::kCare, Purpose::kPrediction, Cause::kMissingTerm);
  const bool weak = checks.unmodelled_share > kWeakModel;
  const Outcome outcome = !passed ? Outcome::kFailed : passed_or(!weak, Outcome::kCare);
  return row(outcome, Purpose::kParameters | Purpose::kPrediction,
             passed && !weak ? Cause::kNone : Cause::kMissingTerm);
}

Evidence parts_of_the_flight(const std::string& name, const CoefficientChecks& checks, double level) {
  const bool known = !std::isnan(checks.contradiction_p);
  const bool passed = checks.contradiction_p >= level;
  Evidence row =
      against(Check::kPartsOfFlight, name, known ? passed_or(passed, Outcome::kFailed) : Outcome::kNotVerified,
              checks.contradiction_p, level);
  row.cause = known ? passed ? Cause::kNone : Cause::kOtherSubject : Cause::kExcitation;
  return std::move(row).with("widening", std::sqrt(std::max(1.0, checks.scatter)));
}

}  // namespace

std::vector<Evidence> coefficient_evidence(const std::string& name, const CoefficientChecks& checks,
                                           const estimation::RegressionComparison& comparison,
                                           const IdentifyOptions& options) {
  std::vector<Evidence> rows{choice_of_method(name, comparison, options),
                             residual_beyond_sensors(name, checks, options.max_unmodelled),
                             holdout(name, checks, options.min_holdout_r2)};
  if (checks.has_holdout) {
    // Bands that do not hold on data that were held out promise too much.
    rows.push_back(row_of(Check::kHoldOutBands, name, checks.outside_bands));
    // An estimate should predict better than what was there before, or no worse than noise makes it.
    if (std::isfinite(checks.error_over_start))
      rows.push_back(row_of(Check::kHoldOutAgainstStart, name, checks.error_over_start));
    rows.push_back(parts_of_the_flight(name, checks, options.contradiction_level));
  }
  if (const estimation::RegressionEstimate* examined = comparison.examined_estimate())
    rows.push_back(estimation::collinearity(*examined, checks.error_ratio < estimation::kNoiseKnownTo));
  rows.insert(rows.end(), comparison.checks.begin(), comparison.checks.end());
  for (Evidence& row : rows) row.about = name;
  return rows;
}

Evidence scatter_row(const std::string& name, const estimation::GroupScatter& scatter,
                     const estimation::RegressionEstimate& chosen) {
  const bool known = scatter.freedom > 0.0;
  Evidence row = against(Check::kScatterBetweenFlights, name,
                         !known            ? Outcome::kNotVerified
                         : scatter.found() ? Outcome::kCare
                                           : Outcome::kPassed,
                         known ? scatter.p : kNaN, estimation::GroupScatter::kLevel);
  row.with("compared", static_cast<double>(scatter.compared)).with("flights", static_cast<double>(scatter.groups));
  row.with("q", scatter.q).with("freedom", scatter.freedom);
  if (row.passed()) return row;
  // The relative scatter of what is not zero says most.
  std::string most = "none";
  double largest = 0.0;
  for (std::size_t j = 0; j < chosen.parameters.size(); ++j) {
    const estimation::Parameter& p = chosen.parameters[j];
    const double share = scatter.between_sigma(j) / std::abs(p.value);
    if (p.status != estimation::ParameterStatus::kIdentified || !(share > largest)) continue;
    largest = share;
    most = p.name;
  }
  row.cause = largest > 0.0 ? Cause::kOtherSubject : Cause::kNone;
  return std::move(row).with("most", std::move(most)).with("share", largest);
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
  // With other terms in alpha its slope is not the parameter's.
  const bool linear_in_alpha =
      std::ranges::count_if(parameters, [](const estimation::Parameter& p) {
        return p.name.find("alpha") != std::string::npos || p.name.find('(') != std::string::npos;
      }) <= 1;
  for (const Expected& e : kExpected) {
    if (coefficient == Coefficient::kCL && !linear_in_alpha) continue;
    const estimation::Parameter* p = estimation::find_parameter(parameters, e.parameter);
    if (p == nullptr || !std::isfinite(p->sigma) || !std::isfinite(p->value)) continue;
    const double size = e.sign * p->value, chance = estimation::kBeyondChance * p->sigma;
    Evidence row = against(Check::kPlausibleSign, p->name,
                           size < -chance  ? Outcome::kCare
                           : size > chance ? Outcome::kPassed
                                           : Outcome::kNotVerified,
                           p->value, 0.0);
    row.sigma = p->sigma;
    if (!row.passed()) row.cause = Cause::kSign;
    rows.push_back(std::move(row).with("sign", e.sign > 0.0 ? "positive" : "negative").with("suspect", e.suspect));
  }
  const estimation::Parameter* slope = estimation::find_parameter(parameters, "CL_alpha");
  if (slope != nullptr && linear_in_alpha && std::isfinite(slope->sigma) && slope->value > 0.0) {
    const double aspect_ratio = subject.span * subject.span / subject.wing_area;
    const double theory = 2.0 * kPi * aspect_ratio / (2.0 + std::sqrt(4.0 + aspect_ratio * aspect_ratio));
    const double low = theory / kLiftSlopeFactor - estimation::kBeyondChance * slope->sigma;
    const double high = theory * kLiftSlopeFactor + estimation::kBeyondChance * slope->sigma;
    Evidence row = against(Check::kPlausibleLiftSlope, slope->name,
                           passed_or(slope->value >= low && slope->value <= high, Outcome::kCare), slope->value,
                           slope->value < theory ? theory / kLiftSlopeFactor : theory * kLiftSlopeFactor);
    row.sigma = slope->sigma;
    if (!row.passed()) row.cause = Cause::kScale;
    rows.push_back(std::move(row).with("aspect_ratio", aspect_ratio).with("theory", theory));
  }
  return rows;
}

}  // namespace veridyn::aircraft
