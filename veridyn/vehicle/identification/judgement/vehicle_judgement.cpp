#include "veridyn/vehicle/identification/judgement/vehicle_judgement.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "veridyn/estimation/judgement/agreement.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/judgement/limits.hpp"
#include "veridyn/vehicle/identification/evidence/drive_evidence.hpp"
#include "veridyn/vehicle/identification/evidence/noise_free.hpp"
#include "veridyn/vehicle/identification/evidence/vehicle_plausibility.hpp"
#include "veridyn/vehicle/identification/fit/axle_estimate.hpp"
#include "veridyn/vehicle/identification/structure/structure_doubt.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::Method;
using estimation::Outcome;
using estimation::Parameter;
using estimation::ParameterStatus;
using estimation::passed_or;
using estimation::Purpose;
using estimation::row_of;

using estimation::kAutocorrelatedFrom;
double percent_explained(const estimation::PredictedQuantity& q) { return 100.0 * std::max(0.0, q.fit.r2); }

/// A residual against what sensors and noisy steering leave, and the share of the output's power that is neither
/// modelled nor noise.
struct ResidualFinding {
  Evidence row;
  double unmodelled = 0.0;
};

/// What exceeds the noise by more than that is known to, and is autocorrelated, is motion that the model does not have.
/// Where there is no noise to compare with, the share tells.
ResidualFinding check_residual(const estimation::PredictedQuantity& q, double sigma, bool noise_free) {
  const double ratio = std::pow(q.fit.rmse / sigma, 2), unexplained = std::max(0.0, 1.0 - q.fit.r2);
  if (noise_free) {
    Evidence row = row_of(Check::kAutocorrelatedResidual, q.name, Outcome::kNotVerified);
    row.cause = Cause::kNoise;
    return {std::move(row), unexplained};
  }
  const estimation::Tolerance& limits = estimation::info_of(Check::kAutocorrelatedResidual).tolerance;
  Evidence row = row_of(Check::kAutocorrelatedResidual, q.name,
                        q.lag1 > kAutocorrelatedFrom ? estimation::outcome_of(ratio, 0.0, limits) : Outcome::kPassed);
  if (!row.passed()) row.cause = Cause::kMissingTerm;
  row.value = ratio;
  row.limit = row.outcome == Outcome::kFailed ? limits.highest : limits.high;
  return {std::move(row), unexplained * std::max(0.0, 1.0 - limits.highest / ratio)};
}

/// What the noise of its sensor and of the steering leaves of an output [its unit]; nothing where it is not judged.
std::optional<double> noise_of(const estimation::PredictedQuantity& q, const DriveSignals& signals,
                               const DriveValidation& by_noise) {
  const auto signal = std::ranges::find(kDriveSignalNames, q.name);
  // A heading is the integral of what is judged.
  if (signal == kDriveSignalNames.end() || *signal == kDriveSignalNames[DriveSignal::kYaw]) return std::nullopt;
  const estimation::PredictedQuantity* by_steering = by_noise.find(q.name);
  return std::hypot(signals.signals[signal - kDriveSignalNames.begin()].sigma,
                    by_steering != nullptr ? by_steering->fit.rmse : 0.0);
}

/// All residuals, and the largest share of an output's power that nothing explains.
std::vector<Evidence> check_residuals(const VehicleProblem& problem, const VehicleFindings& findings) {
  std::vector<Evidence> rows;
  const bool noise_free = is_noise_free(problem.signals, problem.segments.identification);
  double unmodelled = 0.0;
  std::string worst = "outputs";
  for (const estimation::PredictedQuantity& q : findings.fit.quantities) {
    const std::optional<double> sigma = noise_of(q, problem.signals, findings.by_noise);
    if (!sigma) continue;
    ResidualFinding found = check_residual(q, *sigma, noise_free);
    if (found.unmodelled > unmodelled) {
      unmodelled = found.unmodelled;
      worst = q.name;
    }
    rows.push_back(std::move(found.row));
  }
  const double limit = problem.options.max_unmodelled;
  Evidence share = row_of(Check::kUnmodelledShare, worst, passed_or(unmodelled <= limit, Outcome::kFailed));
  if (!share.passed()) share.cause = Cause::kMissingTerm;
  share.value = unmodelled;
  share.limit = limit;
  rows.push_back(std::move(share));
  return rows;
}

/// Where there is nothing to judge a prediction by.
Evidence no_prediction(Cause cause) {
  Evidence row = row_of(Check::kHoldOut, "yaw_rate", Outcome::kMissing);
  row.cause = cause;
  row.bears_on = Purpose::kPrediction;
  return row;
}

/// `yaw_rate` is null where nothing was held out.
Evidence check_prediction(const estimation::PredictedQuantity* yaw_rate, double least_r2) {
  if (yaw_rate == nullptr) return no_prediction(Cause::kMissing);
  Evidence row = row_of(Check::kHoldOut, "yaw_rate", estimation::outcome_of_hold_out(yaw_rate->fit.r2, least_r2));
  row.value = yaw_rate->fit.r2;
  row.limit = row.outcome == Outcome::kCare ? estimation::kHoldOutCare : least_r2;
  // What it predicts poorly but better than nothing is judged as a constant by the other rows.
  if (row.outcome == Outcome::kCare) row.bears_on = Purpose::kPrediction;
  return row;
}

Evidence check_residual_on_holdout(const estimation::PredictedQuantity& there,
                                   const estimation::PredictedQuantity& here) {
  const double ratio = there.fit.rmse / here.fit.rmse;
  const double limit = estimation::info_of(Check::kHoldOutResidual).tolerance.high;
  // What two autocorrelations of white residuals differ by (Bartlett 1946).
  const double chance = estimation::kBeyondChance * std::sqrt(1.0 / static_cast<double>(there.fit.count) +
                                                              1.0 / static_cast<double>(here.fit.count));
  const bool there_alone = !(here.lag1 > kAutocorrelatedFrom) && there.lag1 - here.lag1 > chance;
  const bool systematic = there.lag1 > kAutocorrelatedFrom && (ratio > limit || there_alone);
  Evidence row = row_of(Check::kHoldOutResidual, "yaw_rate", passed_or(!systematic, Outcome::kCare));
  if (systematic) row.cause = Cause::kMissingTerm;
  row.value = ratio;
  row.limit = limit;
  return std::move(row).with("lag1", there.lag1).with("lag1_fit", here.lag1);
}

/// A check by the p value of "they agree". Equation error has linear tyres only: with the Magic Formula its
/// contradictions say no more than that.
Evidence by_p(Check check, double p, const VehicleIdentifyOptions& options) {
  const Outcome otherwise = options.model.tyre == kDriveTyre<LinearTyre> ? Outcome::kFailed : Outcome::kCare;
  Evidence row = row_of(check, "", passed_or(p >= options.contradiction_level, otherwise));
  if (!row.passed()) row.cause = Cause::kMissingTerm;
  row.value = p;
  row.limit = options.contradiction_level;
  return row;
}

/// Equation error against output error, where that has all three parameters.
std::optional<Evidence> check_methods(const VehicleProblem& problem, const AxleEstimate& axle,
                                      const OutputErrorResult* output_error) {
  if (output_error == nullptr || !output_error->estimate.usable) return std::nullopt;
  Eigen::Vector3d difference;
  for (std::size_t i = 0; i < kBasicUnknowns.size(); ++i) {
    const Parameter* p = output_error->estimate.find(kDriveUnknownNames[kBasicUnknowns[i]]);
    if (p == nullptr) return std::nullopt;
    difference(i) = p->value - axle.value(i);
  }
  // Both come from the same data, so the sum of covariances is more than their difference has: a weak test, but one
  // without false alarms.
  Eigen::Matrix3d covariance = axle.covariance;
  covariance += output_error->raw.total_covariance().topLeftCorner(3, 3);
  // Small angles, which only equation error takes.
  covariance.diagonal() += (kSmallAngleError * axle.value).cwiseAbs2();
  return by_p(Check::kMethodsAgree, estimation::agreement_p(difference, covariance), problem.options);
}

}  // namespace

std::vector<Evidence> not_excited_rows(std::span<const std::string> unexcited) {
  Evidence row = row_of(Check::kExcitation, "steer", Outcome::kFailed);
  row.cause = Cause::kExcitation;
  row.value = 0.0;
  row.limit = 1.0;
  row.with("unexcited", fmt::format("{}", fmt::join(unexcited, ", ")));
  return {std::move(row), no_prediction(Cause::kExcitation)};
}

AgreementChecks check_agreement(const VehicleProblem& problem, const VehicleFindings& findings) {
  AgreementChecks checks;
  // The regressions are of the bicycle.
  if (findings.equation_error == nullptr || has_roll(problem.options.model.structure)) return checks;
  const DriveRegressionResult& regression = findings.equation_error->regression;
  const AxleEstimate* axle = regression.find(regression.recommends ? regression.recommended : Method::kGtls);
  if (axle == nullptr || !axle->usable) return checks;
  checks.consistency = by_p(Check::kConsistencyEquation, axle->consistency_p, problem.options);
  checks.methods = check_methods(problem, *axle, findings.output_error);
  return checks;
}

namespace {

/// All rows of an estimate, in the order of the report.
std::vector<Evidence> rows_of(const VehicleProblem& problem, const VehicleFindings& findings, bool excited,
                              std::span<const std::string> unexcited) {
  const estimation::PredictedQuantity* there = findings.validation.find("yaw_rate");
  const estimation::PredictedQuantity* here = findings.fit.find("yaw_rate");
  std::vector<Evidence> rows;
  const auto add = [&](std::vector<Evidence> more) { std::ranges::move(more, std::back_inserter(rows)); };
  add(estimation::unfinished_rows(findings.unfinished));
  // A contradiction in the recording is the cause of others.
  bool agrees = true;
  if (problem.recording != nullptr) {
    KnownByModel known;
    if (const Parameter* p = findings.chosen.find(kDriveUnknownNames[DriveUnknown::kRollGradient]))
      known.roll_gradient = p->value;
    // A model of wrong channels says nothing of their clocks.
    agrees = !contradicts_itself(*problem.recording) && !is_in_doubt(*problem.recording, known);
    if (agrees) known.delay = findings.delay;
    add(recording_rows(*problem.recording, known));
  }
  if (agrees) add(conflict_rows(findings.conflicts));
  add(check_residuals(problem, findings));
  rows.push_back(row_of(Check::kSimulation, "", passed_or(here != nullptr, Outcome::kFailed)));
  const AgreementChecks agreement = check_agreement(problem, findings);
  for (const auto& check : {agreement.consistency, agreement.methods})
    if (check) rows.push_back(*check);
  if (findings.parts) rows.push_back(parts_row(*findings.parts, problem.options.contradiction_level));
  if (std::optional<Evidence> row = doubt_row(findings.structure_doubts, findings.chosen))
    rows.push_back(std::move(*row));
  add(plausibility(findings.chosen.parameters, problem.start));
  add(bound_rows(findings.chosen.parameters));
  if (!excited) {
    add(not_excited_rows(unexcited));
    return rows;
  }
  rows.push_back(check_prediction(there, problem.options.min_holdout_r2));
  if (there != nullptr && here != nullptr) rows.push_back(check_residual_on_holdout(*there, *here));
  add({findings.further.begin(), findings.further.end()});
  return rows;
}

}  // namespace

VehicleJudgement judge_vehicle(const VehicleProblem& problem, const VehicleFindings& findings) {
  std::vector<std::string> identified, unexcited;
  for (const Parameter& p : findings.chosen.parameters) {
    if (is_of_vehicle(p.name)) (p.status == ParameterStatus::kNotExcited ? unexcited : identified).push_back(p.name);
  }
  const bool excited = !identified.empty();
  VehicleJudgement out;
  out.checks = rows_of(problem, findings, excited, unexcited);
  out.judgement = estimation::judge(out.checks);
  out.verdict = excited ? estimation::verdict_of(out.judgement) : estimation::GroupVerdict::kNotExcited;
  if (!excited) {
    out.reason = fmt::format("not excited: the drive does not determine {}", fmt::join(unexcited, ", "));
    return out;
  }

  const estimation::PredictedQuantity* there = findings.validation.find("yaw_rate");
  const std::string holdout =
      there != nullptr ? fmt::format(": {:.1f} % of the yaw rate's variance on the hold-out", percent_explained(*there))
                       : ", without a hold-out to validate on";
  if (out.verdict != estimation::GroupVerdict::kIdentified) {
    const std::vector<std::string>& why = out.judgement.parameters.decided_by;
    out.reason = out.verdict == estimation::GroupVerdict::kEffective
                     ? fmt::format("predicts{}, but its values are no physical constants", holdout.substr(1))
                     : fmt::format("rejected: {}", why.empty() ? "it could not be judged" : why.front());
    return out;
  }
  out.reason =
      fmt::format("{} identified by {}{}", fmt::join(identified, ", "), to_string(findings.chosen.method), holdout);
  if (!unexcited.empty()) out.reason += fmt::format("; not excited: {}", fmt::join(unexcited, ", "));
  return out;
}

}  // namespace veridyn::vehicle
