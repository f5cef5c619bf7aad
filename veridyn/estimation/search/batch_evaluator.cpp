#include "veridyn/estimation/search/batch_evaluator.hpp"

#include <fmt/format.h>

#include <chrono>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/batches/fingerprint.hpp"
#include "veridyn/numerics/parallel.hpp"

namespace veridyn::estimation {
namespace {

std::vector<double> key_of(const Eigen::VectorXd& x) { return {x.begin(), x.end()}; }

/// Of a problem's values at a point.
std::uint64_t fingerprint_of(const BlackBoxProblem& problem, const Eigen::VectorXd& x) {
  numerics::Fingerprint key;
  key.add(problem.name);
  for (const auto& [name, value] : problem.identity) {
    key.add(name);
    key.add(value);
  }
  for (const double value : x) key.add(value);
  return key.value();
}

/// What others are told of an evaluation: how long it took, and its values.
std::vector<double> kept_of(const SearchEvaluation& e) {
  std::vector<double> kept = {e.seconds, e.values.objective};
  kept.insert(kept.end(), e.values.constraints.begin(), e.values.constraints.end());
  return kept;
}

}  // namespace

BatchEvaluator::BatchEvaluator(BlackBoxProblem problem, const EvaluationOptions& options, Progress& progress)
    : problem_(std::move(problem)),
      max_evaluations_(options.max_evaluations),
      progress_(&progress),
      shared_(options.shared) {
  problem_.validate();
  if (!options.log.empty()) log_ = SearchLog(problem_, options.log);
}

bool BatchEvaluator::take_from_log(std::span<const Eigen::VectorXd> points) {
  if (used_ + points.size() > log_.loaded()) {
    if (used_ < log_.loaded())
      throw InputError(log_.path().string(), fmt::format("its last batch, from evaluation {} on, is shorter than the "
                                                         "search's: another version made it; remove it",
                                                         used_ + 1));
    return false;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (key_of(points[i]) != key_of(log_.evaluations()[used_ + i].x))
      throw InputError(log_.path().string(), fmt::format("evaluation {} is at another point than the search's: another "
                                                         "version or other options made it; remove it",
                                                         used_ + i + 1));
    // The others have no such log.
    if (shared_ != nullptr)
      shared_->append(fingerprint_of(problem_, points[i]), kept_of(log_.evaluations()[used_ + i]));
  }
  return true;
}

SearchEvaluation BatchEvaluator::evaluated(std::size_t item, const Eigen::VectorXd& x) const {
  const std::size_t constraints = problem_.constraint_names.size();
  const auto fits = [&](std::size_t count) { return count == 2 + constraints; };
  const auto compute = [&] {
    SearchEvaluation e;
    const auto begun = std::chrono::steady_clock::now();
    e.values = problem_.evaluate(x);
    e.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    VERIDYN_ASSERT(e.values.constraints.size() == constraints);
    return kept_of(e);
  };
  const std::uint64_t key = shared_ == nullptr ? 0 : fingerprint_of(problem_, x);
  const std::vector<double> kept = numerics::kept_or_computed(shared_, key, item, fits, compute);
  SearchEvaluation e;
  e.x = x;
  e.seconds = kept[0];
  e.values = {.objective = kept[1], .constraints = {kept.begin() + 2, kept.end()}};
  return e;
}

bool BatchEvaluator::compute(std::span<const Eigen::VectorXd> points) {
  std::vector<SearchEvaluation> batch(points.size());
  const std::vector<std::size_t> order = numerics::share_of(shared_).own_first(points.size());
  const auto one = [&](std::size_t k) { batch[order[k]] = evaluated(order[k], points[order[k]]); };
  const auto proceed = [&](std::size_t) { return !progress_->interrupted(); };
  if (progress_->interrupted() || !numerics::parallel_for(points.size(), progress_->threads(), one, proceed)) {
    ended_ = SearchTermination::kInterrupted;
    return false;
  }
  log_.append(batch);
  return true;
}

bool BatchEvaluator::evaluate(std::span<const Eigen::VectorXd> points, std::vector<SearchValues>& values) {
  std::vector<Eigen::VectorXd> fresh;
  std::vector<std::size_t> which(points.size());
  std::map<std::vector<double>, std::size_t> added;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::vector<double> key = key_of(points[i]);
    if (const auto known = known_.find(key); known != known_.end()) {
      which[i] = known->second;
      continue;
    }
    const auto [place, is_new] = added.try_emplace(key, used_ + fresh.size());
    if (is_new) fresh.push_back(points[i]);
    which[i] = place->second;
  }
  if (!fresh.empty()) {
    if (fresh.size() > max_evaluations_ - std::min(used_, max_evaluations_)) {
      ended_ = SearchTermination::kEvaluations;
      return false;
    }
    if (!take_from_log(fresh) && !compute(fresh)) return false;
    used_ += fresh.size();
    known_.merge(added);
    for (const SearchEvaluation& e : evaluations().last(fresh.size())) failed_ += e.values.finite() ? 0U : 1U;
  }
  values.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) values[i] = evaluations()[which[i]].values;
  return true;
}

}  // namespace veridyn::estimation
