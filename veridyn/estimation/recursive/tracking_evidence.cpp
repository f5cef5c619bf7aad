#include "veridyn/estimation/recursive/tracking_evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/judgement/limits.hpp"
#include "veridyn/estimation/regression/regression_evidence.hpp"

namespace veridyn::estimation {
namespace {

/// Residual against the sensors' noise, and the share of the variance that is neither modelled nor noise.
std::array<Evidence, 2> residual_rows(const RegressionTracker& tracker) {
  const double ratio = tracker.error_ratio();
  const TrackedPower& power = tracker.power();
  const double residual = tracker.regression().residual_sd();
  const double unexplained = power.deviation > 0.0 ? residual * residual * power.weight / power.deviation : 1.0;
  std::array<Evidence, 2> rows{
      row_of(Check::kResidualBeyondSensors, "", ratio),
      row_of(Check::kUnmodelledShare, "", unexplained * std::max(0.0, 1.0 - kNoiseKnownTo / ratio))};
  for (Evidence& row : rows)
    if (!row.passed()) row.cause = Cause::kMissingTerm;
  return rows;
}

Evidence autocorrelation_row(const RegressionTracker& tracker, const RegressionEstimate& estimate) {
  double worst = 1.0;
  for (const Parameter& p : estimate.parameters)
    if (p.sigma_white > 0.0 && std::isfinite(p.sigma)) worst = std::max(worst, p.sigma / p.sigma_white);
  const double lag1 = tracker.power().lag1();
  const double limit = kBeyondChance / std::sqrt(std::max(1.0, tracker.regression().effective_samples()));
  Evidence row = row_of(Check::kInnovationCorrelation, "", passed_or(!(std::abs(lag1) > limit), Outcome::kCare));
  row.value = lag1;
  row.limit = std::copysign(limit, lag1);
  return std::move(row).with("factor", worst);
}

Evidence excitation_row(const RecursiveRegression& regression) {
  const std::string held = regression.unexcited_text();
  const auto excited = static_cast<double>(regression.excited_directions());
  const auto all = static_cast<double>(regression.parameters());
  const bool complete = held.empty() && excited >= all;
  Evidence row = row_of(Check::kTrackedExcitation, "",
                        complete                        ? Outcome::kPassed
                        : held.empty() || excited > 0.0 ? Outcome::kCare
                                                        : Outcome::kMissing);
  row.value = excited;
  row.limit = all;
  // Methods that do not hold directions only say how many stand above the noise.
  if (!complete) row.cause = held.empty() ? Cause::kNoise : Cause::kExcitation;
  return std::move(row).with("held", held);
}

Evidence scatter_row(const RegressionTracker& tracker) {
  const TrackedScatter scatter = tracker.scatter();
  if (scatter.parts < 2) return row_of(Check::kTrackedParts, "", Outcome::kNotVerified);
  Evidence row = row_of(Check::kTrackedParts, "", scatter.p);
  return std::move(row)
      .with("parts", static_cast<double>(scatter.parts))
      .with("widening", std::sqrt(std::max(1.0, scatter.ratio)));
}

Evidence change_row(const RegressionTracker& tracker) {
  if (!tracker.options().detect_changes) return row_of(Check::kChanges, "", Outcome::kNotVerified);
  const auto& changes = tracker.changes();
  Evidence row = row_of(Check::kChanges, "", static_cast<double>(changes.size()));
  return changes.empty() ? row : std::move(row).with("last", changes.back().detected_s);
}

Evidence prediction_row(const RegressionTracker& tracker) {
  return row_of(Check::kNextRow, "", tracker.power().predicted_share());
}

/// Why there is no estimate.
Evidence missing_row(const RecursiveRegression& regression) {
  Evidence row = row_of(Check::kTrackedEstimate, "", Outcome::kMissing);
  row.value = static_cast<double>(regression.rows());
  row.limit = static_cast<double>(regression.parameters());
  row.cause = row.value > row.limit ? Cause::kExcitation : Cause::kLength;
  return row;
}

std::vector<Evidence> standard_errors(const RegressionEstimate& estimate) {
  std::vector<Evidence> rows;
  for (const Parameter& p : estimate.parameters) {
    if (p.status == ParameterStatus::kFixed || (p.sigma > 0.0 && std::isfinite(p.sigma))) continue;
    Evidence row = row_of(Check::kStandardError, "", Outcome::kFailed);
    row.value = p.sigma;
    row.limit = 0.0;
    rows.push_back(std::move(row).with("parameter", p.name));
  }
  return rows;
}

}  // namespace

std::vector<Evidence> tracking_evidence(const std::string& about, const RegressionTracker& tracker,
                                        const RegressionEstimate& estimate) {
  std::vector<Evidence> rows;
  if (!estimate.usable()) {
    rows.push_back(missing_row(tracker.regression()));
  } else {
    if (std::isfinite(tracker.error_ratio()))
      for (Evidence& row : residual_rows(tracker)) rows.push_back(std::move(row));
    rows.push_back(autocorrelation_row(tracker, estimate));
    rows.push_back(collinearity(estimate, tracker.error_ratio() < kNoiseKnownTo));
    rows.push_back(excitation_row(tracker.regression()));
    rows.push_back(scatter_row(tracker));
    for (Evidence& row : standard_errors(estimate)) rows.push_back(std::move(row));
    rows.push_back(change_row(tracker));
    rows.push_back(prediction_row(tracker));
  }
  for (Evidence& row : rows) row.about = about;
  return rows;
}

}  // namespace veridyn::estimation
