#include "veridyn/vehicle/identification/vehicle_identification.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "veridyn/core/finishing_progress.hpp"
#include "veridyn/vehicle/identification/evidence/drive_evidence.hpp"
#include "veridyn/vehicle/identification/evidence/vehicle_plausibility.hpp"
#include "veridyn/vehicle/identification/fit/corrected_signals.hpp"
#include "veridyn/vehicle/identification/fit/estimated_vehicle.hpp"
#include "veridyn/vehicle/identification/fit/interval_parts.hpp"
#include "veridyn/vehicle/identification/fit/vehicle_estimates.hpp"
#include "veridyn/vehicle/identification/fit/vehicle_profiles.hpp"
#include "veridyn/vehicle/identification/judgement/vehicle_judgement.hpp"
#include "veridyn/vehicle/identification/structure/structure_doubt.hpp"
#include "veridyn/vehicle/identification/structure/structure_ladder.hpp"
#include "veridyn/vehicle/identification/validation/vehicle_prediction.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Parameter;
using estimation::UnfinishedSearch;

VehicleIdentification not_excited(const VehicleProblem& problem) {
  VehicleIdentification out;
  out.identified = problem.start;
  out.verdict = estimation::GroupVerdict::kNotExcited;
  out.reason = fmt::format("there is nothing to identify from: {}", problem.segments.text);
  out.estimates.push_back(unexcited_estimate(problem, out.reason));
  if (problem.recording != nullptr) out.checks = recording_rows(*problem.recording);
  std::vector<std::string> unexcited;
  for (const DriveUnknown u : kBasicUnknowns) unexcited.emplace_back(kDriveUnknownNames[u]);
  for (estimation::Evidence& row : not_excited_rows(unexcited)) out.checks.push_back(std::move(row));
  out.judgement = estimation::judge(out.checks);
  return out;
}

std::string why_no_estimate(std::span<const VehicleEstimate> estimates, const EquationErrorEstimates* equation_error) {
  std::string reason = "no method gave an estimate";
  for (const VehicleEstimate& e : estimates) reason += fmt::format("; {}: {}", to_string(e.method), e.message);
  if (equation_error != nullptr && equation_error->regression.axles.empty())
    reason += "; " + equation_error->regression.reason;
  return reason;
}

/// What the drive does that the model does not is in all methods; what is implausible is each method's own.
std::vector<VehicleEstimate> marked(std::vector<VehicleEstimate> estimates, const VehicleParameters<double>& known,
                                    estimation::GroupVerdict verdict) {
  using estimation::ParameterStatus;
  for (VehicleEstimate& e : estimates) {
    const std::vector<estimation::Evidence> implausible = plausibility(e.parameters, known);
    const std::vector<estimation::Evidence> at_bound = bound_rows(e.parameters);
    e.parameters = estimation::marked(std::move(e.parameters), implausible, ParameterStatus::kImplausible);
    e.parameters = estimation::marked(std::move(e.parameters), at_bound, ParameterStatus::kAtBound);
    e.parameters = estimation::marked(std::move(e.parameters), verdict);
  }
  return estimates;
}

/// With the structure that the options name; `ladder` has its fit.
VehicleIdentification identify_structure(const VehicleProblem& problem,
                                         const std::optional<EquationErrorEstimates>& equation_error,
                                         const StructureLadder& ladder, const FurtherRows& further,
                                         Progress& progress) {
  const EquationErrorEstimates* const by_regression = equation_error ? &*equation_error : nullptr;
  const OutputErrorResult* const output_error = ladder.empty() ? nullptr : &ladder.fit;
  VehicleIdentification out;
  out.identified = problem.start;
  out.structure = problem.options.model.structure;
  out.effects = problem.options.model.effects;
  out.tried_structures = ladder.tried;
  if (equation_error) {
    out.regression = equation_error->regression;
    out.estimates = equation_error->estimates;
  }
  if (output_error != nullptr) {
    out.output_error = output_error->raw;
    out.estimates.push_back(output_error->estimate);
  }
  out.interrupted = progress.interrupted() && (output_error == nullptr || !output_error->raw.has_estimate());
  if (out.interrupted) return out;
  out.chosen =
      choose_method(out.estimates, by_regression ? &by_regression->regression : nullptr, problem.options.method);
  if (out.best() == nullptr) {
    out.reason = why_no_estimate(out.estimates, by_regression);
    if (problem.recording != nullptr) out.checks = recording_rows(*problem.recording);
    out.judgement = estimation::judge(out.checks);
    return out;
  }

  // What an interruption leaves is judged all the same: it takes little time.
  FinishingProgress finishing(progress);
  UnfinishedSearch unfinished = ladder.unfinished;
  if (output_error == nullptr || out.chosen != VehicleMethod::kOutputError) unfinished.converged = true;
  finishing.stage(unfinished.empty() ? "validating on the hold-out"
                                     : "interrupted: validating the best estimate so far (Ctrl-C again ends at once)");
  std::optional<PartsAgreement> parts;
  if (!progress.interrupted()) parts = compare_parts(problem, out.chosen, by_regression, output_error, progress);
  if (progress.interrupted() && !parts) unfinished.left_out.emplace_back("parts of the drive were not compared");
  DriveTheta theta = theta_of(problem, *out.best(), out.output_error ? &*out.output_error : nullptr, finishing);
  const double widening = variance_factor(parts);
  theta.covariance *= widening;
  for (VehicleEstimate& e : out.estimates)
    if (e.method == out.chosen) e = widened(std::move(e), widening, problem.options.significance);
  if (out.chosen == VehicleMethod::kOutputError) out.structure_doubts = ladder.doubts;
  for (VehicleEstimate& e : out.estimates)
    if (e.method == out.chosen) e = with_doubt(std::move(e), out.structure_doubts, problem.options.significance);
  if (output_error != nullptr && !problem.options.profiles.empty() && unfinished.empty()) {
    progress.stage(fmt::format("profile likelihood of {} parameters", problem.options.profiles.size()));
    const bool widened_too = out.chosen == VehicleMethod::kOutputError;
    out.profiles = profile_drive(problem, by_regression, *output_error, widened_too ? widening : 1.0, progress);
    if (progress.interrupted()) unfinished.left_out.emplace_back("profiles were not followed to their ends");
  }
  const VehicleEstimate* const chosen = out.best();
  const DriveModelOptions& model = problem.options.model;
  out.fit = predict_drive(problem.signals, problem.segments.identification, problem.start, model, theta, finishing);
  out.validation = predict_drive(problem.signals, problem.segments.holdout, problem.start, model, theta, finishing);
  const DriveValidation by_noise = with_noisier_inputs(problem, theta, out.fit, finishing);
  out.interrupted = !unfinished.empty();
  const std::vector<estimation::Evidence> more = further ? further(out) : std::vector<estimation::Evidence>();
  VehicleJudgement judgement = judge_vehicle(problem, {.chosen = *chosen,
                                                       .equation_error = by_regression,
                                                       .output_error = output_error,
                                                       .fit = out.fit,
                                                       .validation = out.validation,
                                                       .by_noise = by_noise,
                                                       .parts = parts,
                                                       .delay = ladder.delay,
                                                       .conflicts = ladder.conflicts,
                                                       .structure_doubts = out.structure_doubts,
                                                       .unfinished = unfinished,
                                                       .further = more});
  out.verdict = judgement.verdict;
  out.reason = (out.interrupted ? "interrupted: " : "") + judgement.reason;
  out.checks = std::move(judgement.checks);
  out.judgement = std::move(judgement.judgement);
  if (out.verdict != estimation::GroupVerdict::kRejected)
    out.identified = estimated_parameters(problem.start, chosen->parameters);
  out.estimates = marked(std::move(out.estimates), problem.start, out.verdict);
  return out;
}

}  // namespace

VehicleIdentification identify_parameters(const VehicleProblem& problem, Progress& progress,
                                          const FurtherRows& further) {
  if (problem.segments.identification.empty()) return not_excited(problem);
  std::optional<EquationErrorEstimates> equation_error;
  if (problem.options.equation_error && problem.signals[DriveSignal::kAccelY].available()) {
    progress.stage("equation error");
    equation_error = estimate_by_equation_error(problem);
  }
  StructureLadder ladder;
  if (problem.options.output_error && !progress.interrupted())
    ladder = climb_structures(problem, equation_error ? &*equation_error : nullptr, progress);
  const bool corrects = problem.options.method.value_or(VehicleMethod::kOutputError) == VehicleMethod::kOutputError;
  if (equation_error && corrects && !ladder.empty() && ladder.fit.raw.usable() && !progress.interrupted()) {
    const DriveSignals corrected = corrected_signals(problem.signals, ladder.fit.raw.theta);
    equation_error = estimate_by_equation_error(
        {corrected, problem.segments, problem.start, problem.signal_options, problem.options, problem.recording});
  }
  VehicleIdentifyOptions options = problem.options;
  if (!ladder.empty()) options.model = ladder.model;
  VehicleIdentification out = identify_structure(
      {problem.signals, problem.segments, problem.start, problem.signal_options, options, problem.recording},
      equation_error, ladder, further, progress);
  if (!ladder.reason.empty()) out.structure_reason = std::move(ladder.reason);
  return out;
}

const VehicleEstimate* VehicleIdentification::find(VehicleMethod method) const {
  return find_estimate(estimates, method);
}

namespace {

/// The structures that were tried, in the terms that all domains share.
std::vector<estimation::StructureTrial> structure_trials(const VehicleIdentification& identification) {
  std::vector<estimation::StructureTrial> trials;
  double first = kNaN;
  for (const TriedStructure& tried : identification.tried_structures) {
    estimation::StructureTrial& trial = trials.emplace_back();
    trial.name = name_of(tried.structure, tried.effects);
    if (!tried.usable) {
      trial.obstacle = tried.message;
      continue;
    }
    const bool is_first = std::isnan(first);
    if (is_first) first = tried.negative_log_likelihood;
    if (tried.at_bound && !is_first) trial.obstacle = "an unknown that it adds is at a bound";
    trial.taken = tried.structure == identification.structure && tried.effects == identification.effects;
    trial.log_likelihood_gain = first - tried.negative_log_likelihood;
    if (!is_first) trial.needed_gain = kLikelier * tried.inflation;
    trial.holdout_quantity = kDriveSignalNames[DriveSignal::kYawRate];
    trial.holdout_rmse = tried.holdout_rmse;
    trial.holdout_unit = kDriveSignalUnits[DriveSignal::kYawRate];
    for (std::size_t i = 0; i < kBasicUnknowns.size(); ++i)
      trial.parameters.push_back({.name = std::string(kDriveUnknownNames[kBasicUnknowns[i]]),
                                  .value = tried.value[i],
                                  .sigma = tried.sigma[i],
                                  .unit = std::string(kDriveUnknownUnits[kBasicUnknowns[i]])});
  }
  return trials;
}

}  // namespace

estimation::Estimate make_vehicle_estimate(const VehicleIdentification& identification, const std::string& subject) {
  const VehicleEstimate* best = identification.best();
  estimation::Estimate out = estimation::estimate_of(parameter_group(identification, subject),
                                                     best != nullptr ? best->covariance : Eigen::MatrixXd(),
                                                     identification.validation.quantities);
  out.interrupted = identification.interrupted;
  if (identification.output_error && identification.chosen == VehicleMethod::kOutputError) {
    for (const Parameter& p : out.parameters) {
      const auto unknown = std::ranges::find(kDriveUnknownNames, p.name);
      if (unknown == kDriveUnknownNames.end() || !std::isfinite(p.sigma)) continue;
      const IntervalParts parts =
          interval_parts(*identification.output_error, static_cast<DriveUnknown>(unknown - kDriveUnknownNames.begin()));
      out.interval_parts[p.name] = {{"by_noise", "noise", parts.by_noise},
                                    {"by_budget", "sensors and tyres", parts.by_budget},
                                    {"by_model", "what the model lacks", parts.by_model}};
      const auto at = std::ranges::find(best->parameters, p.name, &Parameter::name) - best->parameters.begin();
      if (at < best->by_steer_scale.size())
        out.interval_parts[p.name].push_back(
            {"by_steer_scale", "scale of the steering", std::abs(best->by_steer_scale(at))});
    }
  }
  if (!identification.structure_doubts.empty())
    for (const Parameter& p : out.parameters)
      out.interval_parts[p.name].push_back(
          {"structure_doubt", "which structure", doubt_of(identification.structure_doubts, p.name)});
  if (identification.output_error)
    for (const estimation::SegmentParameter& p : identification.output_error->segment_parameters)
      if (p.name == kSegmentBank) out.fit[fmt::format("{}.segment_{}", kSegmentBank, p.segment + 1)] = p.value;
  for (const auto* quantities : {&identification.fit.quantities, &identification.fit.roll_quantities}) {
    for (const estimation::PredictedQuantity& q : *quantities) {
      out.fit[q.name + ".r2"] = q.fit.r2;
      out.fit[q.name + ".rmse"] = q.fit.rmse;
      if (std::isfinite(q.lag1)) out.fit[q.name + ".lag1"] = q.lag1;
      if (std::isfinite(q.long_run)) out.fit[q.name + ".long_run"] = q.long_run;
    }
  }
  if (!identification.tried_structures.empty()) {
    out.structure = name_of(identification.structure, identification.effects);
    out.structure_reason = identification.structure_reason;
    out.tried_structures = structure_trials(identification);
  }
  out.warnings = identification.warnings;
  return out;
}

estimation::ParameterGroup parameter_group(const VehicleIdentification& identification, const std::string& subject) {
  estimation::ParameterGroup group{.name = subject,
                                   .verdict = identification.verdict,
                                   .reason = identification.reason,
                                   .evidence = identification.checks,
                                   .judgement = identification.judgement};
  for (const VehicleEstimate& e : identification.estimates)
    group.methods.push_back({std::string(to_string(e.method)), e.usable, e.message, e.parameters});
  if (const VehicleEstimate* best = identification.best()) {
    group.parameters = best->parameters;
    group.method = to_string(best->method);
  }
  return group;
}

std::vector<estimation::Parameter> profiled_parameters(const VehicleIdentification& identification) {
  if (!identification.output_error) return {};
  std::vector<estimation::Parameter> parameters = identification.output_error->parameters;
  const VehicleEstimate* shown = identification.find(VehicleMethod::kOutputError);
  for (estimation::Parameter& p : parameters) {
    if (const estimation::Parameter* estimate = shown != nullptr ? shown->find(p.name) : nullptr) p = *estimate;
  }
  return parameters;
}

}  // namespace veridyn::vehicle
