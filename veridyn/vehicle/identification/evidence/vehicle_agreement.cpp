#include "veridyn/vehicle/identification/evidence/vehicle_agreement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "veridyn/core/index.hpp"
#include "veridyn/vehicle/identification/fit/drive_parametric_model.hpp"

namespace veridyn::vehicle {
namespace {

/// Unknowns that are the vehicle's, not the day's.
constexpr std::array kOfTheVehicle{DriveUnknown::kCf, DriveUnknown::kCr, DriveUnknown::kIz, DriveUnknown::kA,
                                   DriveUnknown::kMu};
/// Longest correlation of residuals that is looked for.
constexpr double kLongestMemory_s = 2.0;
/// Parts that differ by less are one vehicle whose intervals were too narrow.
constexpr double kSameVehicle = 0.05;

PartsAgreement compared(const Eigen::VectorXd& here, const Eigen::VectorXd& there, const Eigen::MatrixXd& covariance) {
  PartsAgreement parts{.agreement = estimation::agreement(there - here, covariance)};
  for (Eigen::Index i = 0; i < here.size(); ++i)
    parts.largest_difference = std::max(parts.largest_difference, std::abs(there(i) - here(i)) / std::abs(here(i)));
  return parts;
}

std::optional<PartsAgreement> by_output_error(const VehicleProblem& problem, const OutputErrorResult& here,
                                              Progress& progress) {
  VehicleParameters<double> start = problem.start;
  start.C_f = here.raw.theta(0);
  start.C_r = here.raw.theta(1);
  start.I_z = here.raw.theta(2);
  DriveModelOptions model_options = problem.options.model;
  model_options.gravity = problem.signal_options.gravity;
  OutputErrorProblem there_problem{
      DriveParametricModel(problem.signals, problem.segments.holdout, start, model_options), {}};
  there_problem.weigh(here.whitening);
  const DriveParametricModel& model = there_problem.model;
  estimation::OutputErrorOptions& options = there_problem.options;
  options.search_start = within_bounds(model, here.raw.theta);
  options.significance = problem.options.significance;
  // From where the other part ended: if both are one vehicle, few steps of Gauss-Newton are as good as all (Le Cam's
  // one-step estimator), and if they are not, few show it.
  options.noise_start = here.raw.noise_covariance.diagonal().cwiseSqrt();
  options.max_relaxations = 1;
  options.max_steps = 3;
  options.max_lag =
      std::max<Eigen::Index>(20, static_cast<Eigen::Index>(kLongestMemory_s * problem.signals.grid.rate_Hz()));
  const estimation::OutputErrorEstimate there = estimation::output_error(model, model.measured(), options, progress);
  if (there.termination != estimation::OutputErrorTermination::kConverged &&
      there.termination != estimation::OutputErrorTermination::kRelaxations)
    return std::nullopt;
  std::vector<Eigen::Index> both;
  for (const DriveUnknown unknown : kOfTheVehicle) {
    const auto i = static_cast<Eigen::Index>(unknown);
    const auto determined = [i](const estimation::OutputErrorEstimate& e) {
      return e.covariance(i, i) > 0.0 && std::isfinite(e.covariance(i, i));
    };
    if (determined(here.raw) && determined(there)) both.push_back(i);
  }
  if (both.empty()) return std::nullopt;
  const Eigen::MatrixXd covariance = here.raw.covariance + there.covariance;
  return compared(here.raw.theta(both), there.theta(both), covariance(both, both));
}

}  // namespace

std::optional<PartsAgreement> compare_parts(const VehicleProblem& problem, VehicleMethod chosen,
                                            const EquationErrorEstimates* equation_error,
                                            const OutputErrorResult* output_error, Progress& progress) {
  if (problem.segments.holdout.empty()) return std::nullopt;
  if (chosen == VehicleMethod::kOutputError && output_error != nullptr)
    return by_output_error(problem, *output_error, progress);
  if (equation_error == nullptr) return std::nullopt;
  const DriveRegressionResult there = regress(problem, problem.segments.holdout, problem.start);
  for (const AxleEstimate& axle : equation_error->regression.axles) {
    if (vehicle_method(axle.method) != chosen || !axle.usable) continue;
    const AxleEstimate* other = there.find(axle.method);
    if (other == nullptr || !other->usable) return std::nullopt;
    return compared(axle.value, other->value, axle.covariance + other->covariance);
  }
  return std::nullopt;
}

double variance_factor(const std::optional<PartsAgreement>& parts) {
  return parts ? std::max(1.0, parts->agreement.ratio) : 1.0;
}

estimation::Evidence parts_row(const PartsAgreement& parts, double contradiction_level) {
  using estimation::Outcome;
  const double factor = std::sqrt(std::max(1.0, parts.agreement.ratio));
  const bool agree = parts.agreement.p >= contradiction_level;
  estimation::Evidence row{.name = "agreement of data parts",
                           .outcome = agree                                      ? Outcome::kPassed
                                      : parts.largest_difference <= kSameVehicle ? Outcome::kCare
                                                                                 : Outcome::kFailed,
                           .value = parts.agreement.p,
                           .limit = contradiction_level,
                           .scale = "p",
                           .bears_on = estimation::Purpose::kParameters};
  row.text = agree ? fmt::format("identification and hold-out data, estimated separately, agree (p = {:.2g})",
                                 parts.agreement.p)
                   : fmt::format(
                         "estimates from two parts of the drive contradict each other beyond their error bars "
                         "(p = {:.1e}) and differ by up to {:.0f} %: the vehicle, the road or the range of "
                         "motion is not the same in both",
                         parts.agreement.p, 100.0 * parts.largest_difference);
  if (factor > 1.0) row.text += fmt::format("; intervals are widened by {:.2f} for their scatter", factor);
  if (!agree) row.advice = "identify gentle and hard driving separately, or drive the same manoeuvres twice";
  return row;
}

VehicleEstimate widened(VehicleEstimate estimate, double factor, double significance) {
  if (!(factor > 1.0)) return estimate;
  // What is not known of mass and geometry is the same in all parts.
  const Eigen::VectorXd before = estimate.covariance.diagonal();
  estimate.covariance *= factor;
  if (estimate.given_covariance.size() > 0) estimate.covariance -= (factor - 1.0) * estimate.given_covariance;
  for (std::size_t i = 0; i < estimate.parameters.size(); ++i) {
    const double ratio = estimate.covariance.diagonal()(signed_index(i)) / before(signed_index(i));
    estimation::widen(estimate.parameters[i], ratio, estimate.degrees_of_freedom, significance);
  }
  return estimate;
}

}  // namespace veridyn::vehicle
