#include "veridyn/vehicle/identification/evidence/budget_conflicts.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/vehicle/identification/options/drive_budget.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;

/// The channels that do not go together in time, either of which may be late; empty of what is no delay.
std::string_view channels_of(DriveUnknown unknown) {
  switch (unknown) {
    case DriveUnknown::kSteerDelay:
      return "steer, yaw_rate";
    case DriveUnknown::kAccelYDelay:
      return "accel_y, yaw_rate";
    default:
      return {};
  }
}

}  // namespace

std::vector<BudgetConflict> budget_conflicts(const DriveModelOptions& model,
                                             const estimation::OutputErrorEstimate& fit) {
  std::vector<BudgetConflict> conflicts;
  for (const DrivePrior& budget : kDriveBudget) {
    const DriveUnknown u = budget.unknown;
    const auto i = static_cast<Eigen::Index>(u);
    if (channels_of(u).empty() || !model.free[u] || !std::isfinite(model.prior[u])) continue;
    const double left = model.prior[u] * model.prior[u] - fit.covariance(i, i);
    const double off = fit.theta(i) - model.start[u];
    if (left > 0.0 && off * off > estimation::kBeyondChance * estimation::kBeyondChance * left)
      conflicts.push_back({.unknown = u,
                           .value = fit.theta(i),
                           .sigma = std::sqrt(fit.covariance(i, i)),
                           .mean = model.start[u],
                           .prior = model.prior[u],
                           .by_chance = std::sqrt(left)});
  }
  return conflicts;
}

std::optional<BudgetConflict> strongest(std::span<const BudgetConflict> conflicts) {
  if (conflicts.empty()) return std::nullopt;
  return std::ranges::max(conflicts, {},
                          [](const BudgetConflict& c) { return std::abs(c.value - c.mean) / c.by_chance; });
}

DriveModelOptions with_widened_prior(DriveModelOptions model, const BudgetConflict& conflict) {
  // A value one standard deviation off is still held back by a share sigma^2/value^2.
  constexpr double kOverValue = 2.0;
  double& prior = model.prior[conflict.unknown];
  prior = std::max(prior, kOverValue * std::abs(conflict.value - conflict.mean));
  return model;
}

std::vector<BudgetConflict> conflicts_now(std::vector<BudgetConflict> widened, const DriveModelOptions& model,
                                          const estimation::OutputErrorEstimate& fit) {
  for (BudgetConflict& c : widened) {
    const auto i = static_cast<Eigen::Index>(c.unknown);
    c.value = fit.theta(i);
    c.sigma = std::sqrt(fit.covariance(i, i));
  }
  for (const BudgetConflict& c : budget_conflicts(model, fit))
    if (std::ranges::find(widened, c.unknown, &BudgetConflict::unknown) == widened.end()) widened.push_back(c);
  return widened;
}

std::vector<Evidence> conflict_rows(std::span<const BudgetConflict> conflicts) {
  std::vector<Evidence> rows;
  for (const BudgetConflict& c : conflicts) {
    if (c.unknown == DriveUnknown::kSteerDelay) continue;
    Evidence row = estimation::row_of(Check::kBeyondPrior, std::string(channels_of(c.unknown)),
                                      (c.value - c.mean) / c.prior, c.sigma / c.prior);
    row.cause = row.passed() ? Cause::kNone : Cause::kDelay;
    const auto* const budget = std::ranges::find(kDriveBudget, c.unknown, &DrivePrior::unknown);
    rows.push_back(std::move(row)
                       .with("unknown", std::string(kDriveUnknownNames[c.unknown]))
                       .with("meaning", std::string(budget->meaning))
                       .with("found", c.value)
                       .with("found_sigma", c.sigma)
                       .with("unit", std::string(kDriveUnknownUnits[c.unknown]))
                       .with("expected", c.mean)
                       .with("expected_sigma", c.prior));
  }
  return rows;
}

}  // namespace veridyn::vehicle
