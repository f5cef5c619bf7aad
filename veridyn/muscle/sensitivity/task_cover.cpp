#include "veridyn/muscle/sensitivity/task_cover.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::muscle {
namespace {

constexpr double kMostSets = 2e6;

/// Whether `a` is the better choice; equal ones are not.
bool excites_more(const TaskSet& a, const TaskSet& b) {
  if (a.excited != b.excited) return a.excited > b.excited;
  if (a.weakest != b.weakest) return a.weakest > b.weakest;
  if (a.mean != b.mean) return a.mean > b.mean;
  return a.overall > b.overall;
}

/// The best two sets that were shown to it.
struct BestTwo {
  std::optional<TaskSet> first, second;

  void consider(const TaskSet& set) {
    if (!first || excites_more(set, *first)) {
      if (first && first->tasks != set.tasks) second = std::move(first);
      first = set;
    } else if (set.tasks != first->tasks && (!second || excites_more(set, *second))) {
      second = set;
    }
  }
};

/// Shares of the greatest NRMSE, of the muscles that count, by task.
class CoverSearch {
 public:
  CoverSearch(Eigen::MatrixXd share, std::vector<std::size_t> muscles, std::vector<std::size_t> tasks, double excites)
      : share_(std::move(share)), muscles_(std::move(muscles)), tasks_(std::move(tasks)), excites_(excites) {}

  [[nodiscard]] TaskSet evaluate(std::vector<std::size_t> tasks) const {
    TaskSet set{.tasks = std::move(tasks), .weakest = muscles_.empty() ? 0.0 : kInfinity};
    std::sort(set.tasks.begin(), set.tasks.end());
    for (const std::size_t m : muscles_) {
      double most = 0.0;
      for (const std::size_t t : set.tasks) {
        most = std::max(most, share_(m, t));
        set.overall += share_(m, t) / static_cast<double>(muscles_.size() * set.tasks.size());
      }
      set.excited += most >= excites_ ? 1U : 0U;
      set.mean += most / static_cast<double>(muscles_.size());
      if (most < set.weakest) {
        set.weakest = most;
        set.weakest_muscle = m;
      }
    }
    return set;
  }
  /// All sets of `count` tasks, or as many as exchanges come by.
  [[nodiscard]] BestTwo best(std::size_t count, bool& exhaustive) const {
    BestTwo two;
    double sets = 1.0;
    for (std::size_t k = 0; k < count; ++k) sets *= static_cast<double>(tasks_.size() - k) / static_cast<double>(k + 1);
    exhaustive = sets <= kMostSets;
    if (exhaustive) {
      std::vector<std::size_t> set;
      enumerate(0, count, set, two);
    } else {
      exchange(count, two);
    }
    return two;
  }
  [[nodiscard]] const std::vector<std::size_t>& tasks() const { return tasks_; }

 private:
  void enumerate(std::size_t from, std::size_t more, std::vector<std::size_t>& set, BestTwo& two) const {
    if (more == 0) return two.consider(evaluate(set));
    for (std::size_t i = from; i + more <= tasks_.size(); ++i) {
      set.push_back(tasks_[i]);
      enumerate(i + 1, more - 1, set, two);
      set.pop_back();
    }
  }
  void exchange(std::size_t count, BestTwo& two) const {
    TaskSet set = evaluate({});
    while (set.tasks.size() < count) {
      std::optional<TaskSet> next;
      for (const std::size_t t : tasks_) {
        if (std::binary_search(set.tasks.begin(), set.tasks.end(), t)) continue;
        std::vector<std::size_t> more = set.tasks;
        more.push_back(t);
        const TaskSet candidate = evaluate(std::move(more));
        if (!next || excites_more(candidate, *next)) next = candidate;
      }
      set = *next;
    }
    two.consider(set);
    for (bool changed = true; changed;) {
      const std::vector<std::size_t> present = two.first->tasks;
      for (std::size_t out = 0; out < count; ++out) {
        for (const std::size_t t : tasks_) {
          if (std::binary_search(present.begin(), present.end(), t)) continue;
          std::vector<std::size_t> other = present;
          other[out] = t;
          two.consider(evaluate(std::move(other)));
        }
      }
      changed = two.first->tasks != present;
    }
  }

  Eigen::MatrixXd share_;
  std::vector<std::size_t> muscles_, tasks_;
  double excites_;
};

}  // namespace

void CoverOptions::validate() const {
  if (!(share > 0.0 && share <= 1.0))
    throw InputError("sensitivity.cover_share", fmt::format("is {}; must be in (0, 1]", share));
  if (!(least_nrmse > 0.0)) throw InputError("sensitivity.least_nrmse", fmt::format("is {}; must be > 0", least_nrmse));
}

TaskCover choose_tasks(const Eigen::MatrixXd& nrmse, const std::vector<bool>& allowed, const CoverOptions& options) {
  options.validate();
  TaskCover cover;
  std::vector<std::size_t> tasks, muscles;
  for (std::size_t t = 0; t < allowed.size(); ++t) {
    if (allowed[t]) tasks.push_back(t);
  }
  Eigen::MatrixXd share = Eigen::MatrixXd::Zero(nrmse.rows(), nrmse.cols());
  cover.excites.resize(allowed.size());
  for (Eigen::Index m = 0; m < nrmse.rows(); ++m) {
    double most = 0.0;
    for (const std::size_t t : tasks) most = std::fmax(most, nrmse(m, t));
    cover.greatest.push_back(most);
    (most >= options.least_nrmse ? muscles : cover.unexcited).push_back(at(m));
    if (most < options.least_nrmse) continue;
    for (Eigen::Index t = 0; t < nrmse.cols(); ++t) {
      share(m, t) = std::isfinite(nrmse(m, t)) ? nrmse(m, t) / most : 0.0;
      if (share(m, t) >= options.share) cover.excites[t].push_back(at(m));
    }
  }
  if (tasks.empty()) return cover;
  const CoverSearch search(std::move(share), muscles, tasks, options.share);
  BestTwo two{};
  if (options.tasks > 0) {
    two = search.best(std::min(options.tasks, tasks.size()), cover.exhaustive);
  } else {
    // Each muscle has a task that excites it, so that as many tasks as muscles are enough.
    for (std::size_t count = 1; count <= std::min(tasks.size(), std::max<std::size_t>(1, muscles.size())); ++count) {
      two = search.best(count, cover.exhaustive);
      if (two.first.has_value() && two.first->excited == muscles.size()) break;
    }
  }
  cover.chosen = two.first;
  cover.runner_up = two.second;
  cover.missed = muscles.size() - cover.chosen->excited;
  return cover;
}

}  // namespace veridyn::muscle
