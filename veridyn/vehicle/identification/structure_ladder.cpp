#include "veridyn/vehicle/identification/structure_ladder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "veridyn/core/index.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/vehicle/identification/vehicle_prediction.hpp"

namespace veridyn::vehicle {
namespace {

/// Median over the parameters of the corrected variance over the white one.
double inflation_of(const estimation::OutputErrorEstimate& fit) {
  std::vector<double> ratios;
  for (const estimation::Parameter& p : fit.parameters) {
    const double ratio = std::pow(p.sigma / p.sigma_white, 2);
    if (p.sigma > 0.0 && std::isfinite(ratio)) ratios.push_back(ratio);
  }
  return ratios.empty() ? 1.0 : std::max(1.0, numerics::median(ratios));
}

/// How a fit does, on its own data and on the hold-out.
TriedStructure tried(const VehicleProblem& problem, const OutputErrorResult& fit, Progress& progress) {
  TriedStructure out{
      .structure = problem.options.model.structure, .usable = fit.raw.usable(), .message = fit.raw.message};
  if (!out.usable) return out;
  out.negative_log_likelihood = fit.raw.negative_log_likelihood;
  out.inflation = inflation_of(fit.raw);
  std::vector<DriveUnknown> added{DriveUnknown::kRollGradient, DriveUnknown::kRollFrequency,
                                  DriveUnknown::kRollDamping};
  const DriveStructure structure = problem.options.model.structure;
  added.push_back(structure == DriveStructure::kSaturation ? DriveUnknown::kMu : DriveUnknown::kRelaxationLength);
  out.at_bound = std::ranges::any_of(added, [&](DriveUnknown u) {
    return fit.raw.parameters[static_cast<std::size_t>(u)].status == estimation::ParameterStatus::kAtBound;
  });
  constexpr std::array kShown{DriveUnknown::kCf, DriveUnknown::kCr, DriveUnknown::kIz};
  for (std::size_t i = 0; i < kShown.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(kShown[i]);
    out.value[i] = fit.raw.theta(row);
    out.sigma[i] = std::sqrt(fit.raw.covariance(row, row));
  }
  if (problem.segments.holdout.empty() || progress.interrupted()) return out;
  const DriveValidation there = predict_drive(problem.signals, problem.segments.holdout, problem.start,
                                              problem.options.model, {fit.raw.theta, {}}, progress);
  if (const estimation::PredictedQuantity* yaw_rate = there.find("yaw_rate")) out.holdout_rmse = yaw_rate->fit.rmse;
  out.holdout_misfit = 0.0;
  for (const estimation::OutputFit& output : fit.raw.outputs)
    if (const estimation::PredictedQuantity* q = there.find(output.name)) out.holdout_misfit += std::log(q->fit.rmse);
  return out;
}

/// Whether an output error leaves no more than the sensors do, or than rounding of a model does.
bool is_explained(const VehicleProblem& problem, const OutputErrorResult& fit) {
  if (!fit.raw.usable()) return false;
  constexpr double kRounding = 1e-3;  // of an output's standard deviation
  const OutputErrorProblem given = output_error_problem(problem, nullptr);
  const Eigen::VectorXd expected = given.model.expected_residual(fit.raw.theta);
  for (std::size_t i = 0; i < fit.raw.outputs.size(); ++i) {
    const estimation::OutputFit& output = fit.raw.outputs[i];
    const double sigma = expected(signed_index(i)), left = output.fit.rmse;
    const double rounding = left * left / std::max(1e-300, 1.0 - output.fit.r2) * kRounding * kRounding;
    if (!(left * left <= kExplained * sigma * sigma + rounding)) return false;
  }
  return true;
}

VehicleProblem with_options(const VehicleProblem& problem, const VehicleIdentifyOptions& options) {
  return {problem.signals, problem.segments, problem.start, problem.signal_options, options, problem.recording};
}

/// Nothing for a bicycle, of which the signals alone show it, and where the search fails.
std::optional<estimation::Parameter> steer_delay_of(const VehicleProblem& problem,
                                                    const EquationErrorEstimates* equation_error,
                                                    const OutputErrorResult& fit, Progress& progress) {
  if (!has_roll(problem.options.model.structure) || !fit.raw.usable() || progress.interrupted()) return std::nullopt;
  VehicleIdentifyOptions options = problem.options;
  options.model.free[DriveUnknown::kSteerDelay] = true;
  const OutputErrorResult delayed = estimate_by_output_error(with_options(problem, options), equation_error,
                                                             fit.raw.theta, SearchEffort::kToCompare, progress);
  if (!delayed.raw.usable()) return std::nullopt;
  return delayed.raw.parameters[static_cast<std::size_t>(DriveUnknown::kSteerDelay)];
}

/// The options for a structure. Saturation has no relaxation length where the data did not ask for one.
VehicleIdentifyOptions with_structure(VehicleIdentifyOptions options, DriveStructure structure, bool relaxes) {
  options.model = with_structure(options.model, structure);
  if (structure != DriveStructure::kSaturation || relaxes) return options;
  options.model.free[DriveUnknown::kRelaxationLength] = false;
  options.model.start[DriveUnknown::kRelaxationLength] = 0.0;
  return options;
}

std::string reason_of(const StructureLadder& ladder, bool contradicts) {
  const TriedStructure& taken = ladder.tried[ladder.chosen];
  std::string reason = fmt::format("structure: {}", to_string(taken.structure));
  if (ladder.chosen > 0) {
    const TriedStructure& before = ladder.tried.front();
    reason += fmt::format(", which makes the drive likelier than {} does by a log-likelihood of {:.0f}",
                          to_string(before.structure), before.negative_log_likelihood - taken.negative_log_likelihood);
  } else if (ladder.tried.size() > 1) {
    reason += ": none richer makes the drive likelier";
  } else {
    reason += contradicts ? ": the recording contradicts itself, and nothing richer was tried on it"
                          : ": it leaves no more than the sensors do";
  }
  return reason;
}

}  // namespace

StructureLadder climb_structures(const VehicleProblem& problem, const EquationErrorEstimates* equation_error,
                                 Progress& progress) {
  StructureLadder ladder;
  std::vector<OutputErrorResult> fits;
  std::vector<VehicleIdentifyOptions> options;
  const bool fixed = problem.options.structure.has_value();
  const bool contradicts = std::ranges::any_of(
      problem.recording, [](const estimation::Evidence& row) { return row.outcome == estimation::Outcome::kFailed; });
  Eigen::VectorXd search_start;
  bool explained = false;
  for (const DriveStructure structure : enumerators<DriveStructure, kDriveStructures>()) {
    if (progress.interrupted()) break;
    if (fixed && *problem.options.structure != structure) continue;
    const bool has_accel = problem.signals[DriveSignal::kAccelY].available();
    if (!fixed && structure == DriveStructure::kScaledAccel && !has_accel) continue;
    if (!fixed && structure == DriveStructure::kRelaxation && explained) continue;
    progress.stage(fmt::format("output error, structure: {}", to_string(structure)));
    const bool relaxes = fixed || (!ladder.empty() && ladder.tried[choose_structure(ladder.tried)].structure ==
                                                          DriveStructure::kRelaxation);
    options.push_back(with_structure(problem.options, structure, relaxes));
    const VehicleProblem given = with_options(problem, options.back());
    OutputErrorResult fit =
        estimate_by_output_error(given, equation_error, search_start, SearchEffort::kToCompare, progress);
    ladder.tried.push_back(tried(given, fit, progress));
    if (fit.raw.usable()) search_start = fit.raw.theta;
    explained = is_explained(given, fit);
    fits.push_back(std::move(fit));
    const bool rolls = has_roll(ladder.tried[choose_structure(ladder.tried)].structure);
    const bool simple = structure < DriveStructure::kRoll;
    if (contradicts || (simple ? explained : !rolls)) break;
  }
  ladder.chosen = choose_structure(ladder.tried);
  if (!ladder.empty() && !progress.interrupted()) {
    progress.stage("output error");
    ladder.model = options[ladder.chosen].model;
    const VehicleProblem given = with_options(problem, options[ladder.chosen]);
    ladder.fit = refined(std::move(fits[ladder.chosen]), given, equation_error, progress);
    ladder.steer_delay = steer_delay_of(given, equation_error, ladder.fit, progress);
  }
  if (!fixed && !ladder.empty()) ladder.reason = reason_of(ladder, contradicts);
  return ladder;
}

}  // namespace veridyn::vehicle
