#include "veridyn/estimation/search/batch_evaluator.hpp"

#include <fmt/format.h>

#include <chrono>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::estimation {
namespace {

std::vector<double> key_of(const Eigen::VectorXd& x) { return {x.begin(), x.end()}; }

}  // namespace

BatchEvaluator::BatchEvaluator(BlackBoxProblem problem, const EvaluationOptions& options, Progress& progress)
    : problem_(std::move(problem)), max_evaluations_(options.max_evaluations), progress_(&progress) {
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
  }
  return true;
}

SearchEvaluation BatchEvaluator::evaluated(const Eigen::VectorXd& x) const {
  const auto begun = std::chrono::steady_clock::now();
  SearchEvaluation e{.x = x, .values = problem_.evaluate(x)};
  e.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  VERIDYN_ASSERT(e.values.constraints.size() == problem_.constraint_names.size());
  return e;
}

bool BatchEvaluator::compute(std::span<const Eigen::VectorXd> points) {
  std::vector<SearchEvaluation> batch(points.size());
  const auto one = [&](std::size_t k) { batch[k] = evaluated(points[k]); };
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
