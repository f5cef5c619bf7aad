#include "veridyn/vehicle/identification/structure/structure_doubt.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "veridyn/core/index.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/vehicle/identification/options/drive_model_options.hpp"

namespace veridyn::vehicle {
namespace {

/// By how much a doubt moves a parameter; 0 where it does not have it.
double difference_of(const StructureDoubt& doubt, std::string_view parameter) {
  for (const auto& [name, difference] : doubt.difference)
    if (name == parameter) return difference;
  return 0.0;
}

}  // namespace

StructureDoubt structure_doubt(DriveStructure structure, double probability, const VehicleEstimate& other,
                               const VehicleEstimate& taken) {
  StructureDoubt doubt{.structure = structure, .probability = probability};
  for (const estimation::Parameter& p : taken.parameters)
    if (const estimation::Parameter* there = other.find(p.name))
      doubt.difference.emplace_back(p.name, there->value - p.value);
  return doubt;
}

VehicleEstimate with_doubt(VehicleEstimate estimate, std::span<const StructureDoubt> doubts, double significance) {
  const auto n = signed_index(estimate.parameters.size());
  Eigen::MatrixXd grown = estimate.covariance;
  for (const StructureDoubt& doubt : doubts) {
    Eigen::VectorXd difference(n);
    for (Eigen::Index i = 0; i < n; ++i) difference(i) = difference_of(doubt, estimate.parameters[i].name);
    grown += doubt.probability * difference * difference.transpose();
  }
  return with_covariance(std::move(estimate), std::move(grown), significance);
}

double doubt_of(std::span<const StructureDoubt> doubts, std::string_view parameter) {
  double variance = 0.0;
  for (const StructureDoubt& doubt : doubts) {
    const double difference = difference_of(doubt, parameter);
    variance += doubt.probability * difference * difference;
  }
  return std::sqrt(variance);
}

std::optional<estimation::Evidence> doubt_row(std::span<const StructureDoubt> doubts, const VehicleEstimate& estimate) {
  if (doubts.empty()) return std::nullopt;
  // Of a parameter's standard error, which has it: half of its variance.
  const double kLimit = std::sqrt(0.5);
  std::vector<std::string> structures, named;
  for (const StructureDoubt& doubt : doubts)
    structures.push_back(
        fmt::format("{} (probability {:.2g})", name_of(doubt.structure, doubt.effects), doubt.probability));
  double largest = 0.0;
  for (const estimation::Parameter& p : estimate.parameters) {
    if (!is_one_of(p.name, kBasicUnknowns) || !(p.sigma > 0.0)) continue;
    const double doubt = doubt_of(doubts, p.name);
    largest = std::max(largest, doubt / p.sigma);
    if (doubt > kLimit * p.sigma)
      named.push_back(fmt::format("{} by {:.1f} %", p.name, 100.0 * doubt / std::abs(p.value)));
  }
  using estimation::Outcome;
  estimation::Evidence row = estimation::row_of(estimation::Check::kStructureDoubt, "",
                                                estimation::passed_or(named.empty(), Outcome::kNotVerified));
  if (!named.empty()) row.cause = estimation::Cause::kMissingTerm;
  row.value = largest;
  row.limit = kLimit;
  return std::move(row)
      .with("structures", fmt::format("{}", fmt::join(structures, " and ")))
      .with("parameters", fmt::format("{}", fmt::join(named, ", ")));
}

}  // namespace veridyn::vehicle
