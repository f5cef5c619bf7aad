#include "veridyn/vehicle/identification/evidence/vehicle_agreement.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "veridyn/core/index.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::vehicle {
namespace {

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
  const std::optional<estimation::OutputErrorEstimate> fitted =
      fitted_again(problem, problem.segments.holdout, problem.options.model, here.raw, kLongestMemory_s, progress);
  if (!fitted) return std::nullopt;
  const estimation::OutputErrorEstimate& there = *fitted;
  std::vector<Eigen::Index> both;
  for (const DriveUnknown unknown : kVehicleUnknowns) {
    const auto i = static_cast<Eigen::Index>(unknown);
    const auto determined = [i](const estimation::OutputErrorEstimate& e) {
      return e.covariance(i, i) > 0.0 && std::isfinite(e.covariance(i, i));
    };
    if (determined(here.raw) && determined(there)) both.push_back(i);
  }
  if (both.empty()) return std::nullopt;
  const Eigen::MatrixXd covariance = here.raw.total_covariance() + there.total_covariance();
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
  const Outcome otherwise = parts.largest_difference <= kSameVehicle ? Outcome::kCare : Outcome::kFailed;
  estimation::Evidence row = estimation::row_of(
      estimation::Check::kPartsOfDrive, "", estimation::passed_or(parts.agreement.p >= contradiction_level, otherwise));
  if (!row.passed()) row.cause = estimation::Cause::kOtherSubject;
  row.value = parts.agreement.p;
  row.limit = contradiction_level;
  return std::move(row)
      .with("difference", parts.largest_difference)
      .with("widened", std::sqrt(std::max(1.0, parts.agreement.ratio)));
}

VehicleEstimate widened(VehicleEstimate estimate, double factor, double significance) {
  if (!(factor > 1.0)) return estimate;
  // What is not known of mass and geometry is the same in all parts.
  Eigen::MatrixXd grown = factor * estimate.covariance;
  if (estimate.given_covariance.size() > 0) grown -= (factor - 1.0) * estimate.given_covariance;
  return with_covariance(std::move(estimate), std::move(grown), significance);
}

}  // namespace veridyn::vehicle
