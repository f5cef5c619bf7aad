#include "veridyn/muscle/identification/task_judgement.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::muscle {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::info_of;
using estimation::Outcome;
using estimation::ParameterStatus;
using estimation::passed_or;
using estimation::row_of;

/// NRMSE of unseen tasks that is good enough whatever the noise.
constexpr double kGoodNrmse = 0.01;

double trained_rmse(const std::vector<TaskOutcome>& tasks) {
  double sum = 0.0, count = 0.0;
  for (const TaskOutcome& t : tasks) {
    if (t.hold_out || !std::isfinite(t.after.rmse)) continue;
    sum += t.after.rmse * t.after.rmse;
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(sum / count) : kNaN;
}

double trained_range(const std::vector<TaskOutcome>& tasks) {
  double range = 0.0;
  for (const TaskOutcome& t : tasks)
    if (!t.hold_out) range = std::max(range, t.before.range);
  return range;
}

Evidence check_residual(const TaskFindings& f) {
  if (!f.noise_known) return row_of(Check::kTaskResidual, "", Outcome::kNotVerified);
  const estimation::Tolerance& tolerance = info_of(Check::kTaskResidual).tolerance;
  const double chi_square = f.estimate.chi_square;
  const double by_chance = 1.0 + 4.0 * std::sqrt(2.0 / f.estimate.freedom);
  const bool small = chi_square<tolerance.low, large = chi_square> by_chance;
  Evidence row =
      row_of(Check::kTaskResidual, "",
             large && chi_square > tolerance.highest ? Outcome::kFailed : passed_or(!small && !large, Outcome::kCare));
  row.value = chi_square;
  row.limit = small ? tolerance.low : row.outcome == Outcome::kFailed ? tolerance.highest : by_chance;
  if (small) row.cause = Cause::kNoise;
  if (large) row.cause = f.along_angles ? Cause::kSwap : Cause::kMissingTerm;
  return std::move(row).with("times", std::sqrt(std::max(0.0, chi_square)));
}

Evidence check_correlation(const TaskFindings& f) {
  const double share = trained_rmse(f.tasks) / std::max(1e-300, trained_range(f.tasks));
  const bool numerical = share < kIntegrationShare;
  const Eigen::VectorXd& of_noise = f.estimate.noise_correlation;
  const double limit = info_of(Check::kResidualCorrelation).tolerance.high;
  const bool alike = f.estimate.lag1 > limit;
  const Outcome otherwise = numerical || f.noise_known ? Outcome::kCare : Outcome::kFailed;
  Evidence row = row_of(Check::kResidualCorrelation, "", passed_or(!alike, otherwise));
  row.value = f.estimate.lag1;
  row.limit = limit;
  if (alike) row.cause = numerical ? Cause::kResolution : of_noise.size() > 0 ? Cause::kNoise : Cause::kMissingTerm;
  return std::move(row).with("share", share).with("of_noise", of_noise.size() > 0 ? of_noise.maxCoeff() : 0.0);
}

std::vector<Evidence> check_bounds(const TaskFindings& f) {
  std::vector<Evidence> rows;
  for (const estimation::Parameter& p : f.estimate.best.parameters) {
    if (p.status != ParameterStatus::kAtBound) continue;
    Evidence row = row_of(Check::kAtBound, p.name, Outcome::kCare);
    row.cause = Cause::kBound;
    row.value = row.limit = p.value;
    rows.push_back(std::move(row).with("unit", p.unit));
  }
  return rows;
}

Evidence check_searches(const TaskFindings& f) {
  std::size_t finished = 0, agreeing = 0;
  for (const TaskSearch& s : f.estimate.searches) {
    finished += std::isfinite(s.cost) ? 1 : 0;
    agreeing += std::isfinite(s.cost) && s.agrees ? 1 : 0;
  }
  Evidence row = row_of(Check::kSearchesAgree, "",
                        finished < 2 ? Outcome::kNotVerified : passed_or(!f.estimate.ambiguous, Outcome::kCare));
  row.value = static_cast<double>(agreeing);
  row.limit = static_cast<double>(finished);
  return row;
}

bool is_open(const estimation::Parameter& p) {
  return p.status != ParameterStatus::kIdentified && p.status != ParameterStatus::kFixed;
}

Evidence check_determined(const TaskFindings& f) {
  std::vector<std::string> open;
  double identified = 0.0;
  for (const estimation::Parameter& p : f.estimate.best.parameters) {
    if (is_open(p)) open.push_back(p.name);
    if (p.status == ParameterStatus::kIdentified) identified += 1.0;
  }
  const std::vector<std::string>& combinations = f.estimate.null_directions;
  Evidence row = row_of(Check::kDeterminedByTasks, "",
                        identified == 0.0 ? Outcome::kFailed : passed_or(open.empty(), Outcome::kCare));
  row.value = identified;
  row.limit = identified + static_cast<double>(open.size());
  if (!row.passed()) row.cause = combinations.empty() ? Cause::kExcitation : Cause::kCollinear;
  return std::move(row)
      .with("open", fmt::format("{}", fmt::join(open, ", ")))
      .with("combination", combinations.empty() ? std::string() : combinations.front());
}

/// Whether the estimate is near enough to where it began for intervals on a line about it.
Evidence check_distance(const TaskFindings& f) {
  const bool open = std::ranges::any_of(f.estimate.best.parameters, is_open);
  const double limit = info_of(Check::kDistanceFromStart).tolerance.highest;
  Evidence row =
      row_of(Check::kDistanceFromStart, "", passed_or(!(open && f.estimate.distance > limit), Outcome::kFailed));
  row.value = f.estimate.distance;
  row.limit = limit;
  if (!row.passed()) row.cause = Cause::kExcitation;
  return row;
}

/// How many there are, and those of them that are of no use.
std::vector<Evidence> check_tasks(const TaskFindings& f) {
  std::size_t trained = 0, unfinished = 0;
  std::vector<std::string> still;
  for (const TaskOutcome& t : f.tasks) {
    trained += t.hold_out ? 0 : 1;
    unfinished += t.estimated.size() == 0 ? 1 : 0;
    if (!t.before.moves) still.push_back(t.name);
  }
  const auto row = [](Check check, std::size_t count, Cause cause) {
    Evidence made = row_of(check, "", static_cast<double>(count));
    if (!made.passed()) made.cause = cause;
    return made;
  };
  std::vector<Evidence> rows{row(Check::kTasks, trained, Cause::kExcitation)};
  if (!still.empty())
    rows.push_back(row(Check::kStillTasks, still.size(), Cause::kExcitation)
                       .with("tasks", fmt::format("{}", fmt::join(still, ", "))));
  if (unfinished > 0)
    rows.push_back(
        row(Check::kUnfinishedTasks, unfinished, Cause::kMissing).with("tasks", static_cast<double>(f.tasks.size())));
  if (!f.unused.empty())
    rows.push_back(row(Check::kUnusedTasks, f.unused.size(), Cause::kMissing)
                       .with("tasks", fmt::format("{}", fmt::join(f.unused, "; "))));
  return rows;
}

Evidence check_wraps(const TaskFindings& f) {
  Evidence row = row_of(Check::kWraps, "", static_cast<double>(f.wrap_warnings.size()));
  if (row.passed()) return row;
  row.cause = Cause::kSubject;
  return std::move(row).with("first", f.wrap_warnings.front());
}

Evidence check_reserves(const TaskFindings& f) {
  const TaskOutcome* most = nullptr;
  for (const TaskOutcome& t : f.tasks)
    if (!t.hold_out && (most == nullptr || t.reserve_share > most->reserve_share)) most = &t;
  Evidence row = row_of(Check::kReserves, "", most != nullptr ? most->reserve_share : 0.0);
  if (row.passed()) return row;
  row.cause = Cause::kMissingTerm;
  return std::move(row).with("task", most->name);
}

Evidence taken_as_given(bool along_angles) {
  Evidence row = row_of(Check::kTakenAsGiven, "", Outcome::kNotVerified);
  row.cause = along_angles ? Cause::kSwap : Cause::kSubject;
  return row;
}

}  // namespace

std::vector<Evidence> judge_hold_out(const std::vector<TaskOutcome>& tasks, double noise, double trained) {
  double worst = -1.0, standard = 0.0, excess = 0.0;
  std::size_t count = 0, as_well = 0, failed = 0;
  std::string name;
  const double chance = estimation::kBeyondChance * std::max(std::isfinite(trained) ? trained : 0.0, noise);
  for (const TaskOutcome& t : tasks) {
    if (!t.hold_out || !t.before.moves) continue;
    ++count;
    failed += std::isfinite(t.after.nrmse) ? 0 : 1;
    as_well += t.after.rmse < t.before.rmse || !std::isfinite(t.before.rmse) ? 0 : 1;
    excess = std::max(excess, t.after.rmse / std::max(chance, kGoodNrmse * t.before.range));
    if (t.after.nrmse > worst) {
      worst = t.after.nrmse;
      standard = t.before.nrmse;
      name = t.name;
    }
  }
  if (count == 0) return {row_of(Check::kUnseenTasks, "", Outcome::kMissing)};
  const double limit = info_of(Check::kUnseenTasks).tolerance.high;
  const bool beyond = excess > limit;
  // Within noise and fit nothing is to be bettered.
  const std::size_t no_better = beyond ? as_well : 0;
  Evidence row = row_of(Check::kUnseenTasks, "",
                        failed > 0 || no_better > 0 ? Outcome::kFailed : passed_or(!beyond, Outcome::kCare));
  row.value = failed > 0 ? kNaN : excess;
  row.limit = limit;
  if (!row.passed()) row.cause = failed > 0 ? Cause::kMissing : Cause::kMissingTerm;
  std::vector<Evidence> rows{std::move(row)
                                 .with("nrmse", worst)
                                 .with("standard", standard)
                                 .with("task", name)
                                 .with("as_well", static_cast<double>(no_better))
                                 .with("failed", static_cast<double>(failed))
                                 .with("tasks", static_cast<double>(count))};
  if (failed == 0 && no_better > 0)
    rows.push_back(row_of(Check::kBetterThanStandard, "", static_cast<double>(no_better))
                       .with("tasks", static_cast<double>(count)));
  return rows;
}

std::vector<Evidence> judge_tasks(const TaskFindings& f) {
  std::vector<Evidence> rows = check_tasks(f);
  rows.push_back(check_residual(f));
  rows.push_back(check_correlation(f));
  rows.push_back(check_determined(f));
  for (Evidence& row : check_bounds(f)) rows.push_back(std::move(row));
  rows.push_back(check_searches(f));
  if (!f.along_angles) rows.push_back(check_distance(f));
  rows.push_back(check_wraps(f));
  rows.push_back(check_reserves(f));
  for (Evidence& row : judge_hold_out(f.tasks, f.noise, trained_rmse(f.tasks))) rows.push_back(std::move(row));
  rows.push_back(taken_as_given(f.along_angles));
  return rows;
}

}  // namespace veridyn::muscle
