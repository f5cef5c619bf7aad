#include "veridyn/estimation/search/particle_swarm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/sensitivity_indices.hpp"

namespace veridyn::estimation {
namespace {

/// View of an evaluator: particles with their bests.
class Swarm {
 public:
  Swarm(const BlackBoxProblem& problem, std::size_t particles, std::uint64_t seed, std::size_t number)
      : problem_(&problem), random_(seed, fmt::format("particle swarm {}", number)) {
    const Eigen::VectorXd size = problem.high - problem.low;
    const Eigen::MatrixXd points = numerics::sobol_points(particles, at(problem.size()), random_.index(1ULL << 62));
    for (std::size_t i = 0; i < particles; ++i) {
      x_.push_back(problem.low + points.row(i).transpose().cwiseProduct(size));
      // Half way to another point within the bounds (Clerc's start): most particles stay inside at first.
      Eigen::VectorXd v(problem.size());
      for (Eigen::Index j = 0; j < v.size(); ++j)
        v(j) = 0.5 * (problem.low(j) + random_.uniform() * size(j) - x_.back()(j));
      v_.push_back(std::move(v));
    }
    best_x_ = x_;
    best_.resize(particles);
  }

  [[nodiscard]] const std::vector<Eigen::VectorXd>& positions() const { return x_; }
  [[nodiscard]] std::size_t best() const {
    std::size_t b = 0;
    for (std::size_t i = 1; i < best_.size(); ++i) b = better(best_[i], best_[b]) ? i : b;
    return b;
  }
  [[nodiscard]] const SearchValues& values_of(std::size_t i) const { return best_[i]; }
  [[nodiscard]] const Eigen::VectorXd& point_of(std::size_t i) const { return best_x_[i]; }

  void learn(const std::vector<SearchValues>& values) {
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (!better(values[i], best_[i])) continue;
      best_[i] = values[i];
      best_x_[i] = x_[i];
    }
  }
  void move(std::size_t neighbours) {
    constexpr double kInertia = 0.7298, kAttraction = 1.49618;
    const std::size_t n = x_.size(), reach = std::min(neighbours, (n - 1) / 2);
    for (std::size_t i = 0; i < n; ++i) {
      std::size_t leader = i;
      for (std::size_t k = n - reach; k <= n + reach; ++k) {
        const std::size_t other = (i + k) % n;
        if (better(best_[other], best_[leader])) leader = other;
      }
      for (Eigen::Index j = 0; j < problem_->size(); ++j) {
        double& v = v_[i](j);
        double& x = x_[i](j);
        const double to_best = random_.uniform() * (best_x_[i](j) - x);
        const double others = random_.uniform() * (best_x_[leader](j) - x);
        v = kInertia * v + kAttraction * (to_best + others);
        x += v;
        if (x >= problem_->low(j) && x <= problem_->high(j)) continue;
        x = std::clamp(x, problem_->low(j), problem_->high(j));
        v = 0.0;
      }
    }
  }
  /// Largest distance between particles in a coordinate, in the bounds' distance.
  [[nodiscard]] double extent() const {
    double extent = 0.0;
    for (Eigen::Index j = 0; j < problem_->size(); ++j) {
      const auto [least, most] =
          std::minmax_element(x_.begin(), x_.end(), [j](const auto& a, const auto& b) { return a(j) < b(j); });
      extent = std::max(extent, ((*most)(j) - (*least)(j)) / (problem_->high(j) - problem_->low(j)));
    }
    return extent;
  }

 private:
  const BlackBoxProblem* problem_;
  numerics::RandomStream random_;
  std::vector<Eigen::VectorXd> x_, v_, best_x_;
  std::vector<SearchValues> best_;
};

/// One swarm to its end; what it found goes into `result` where it is better.
SearchTermination run_swarm(BatchEvaluator& evaluator, const SwarmOptions& options, std::size_t particles,
                            std::size_t number, SearchResult& result) {
  Swarm swarm(evaluator.problem(), particles, options.seed, number);
  std::vector<SearchValues> values;
  for (std::size_t iteration = 0; iteration < options.iterations; ++iteration) {
    if (!evaluator.evaluate(swarm.positions(), values)) return evaluator.ended();
    ++result.iterations;
    swarm.learn(values);
    const std::size_t best = swarm.best();
    if (result.x.size() == 0 || better(swarm.values_of(best), result.values)) {
      result.x = swarm.point_of(best);
      result.values = swarm.values_of(best);
    }
    if (options.stop_at_feasible && result.values.feasible()) return SearchTermination::kFeasible;
    if (swarm.extent() < options.tolerance) return SearchTermination::kConverged;
    swarm.move(options.neighbours);
    if (!evaluator.progress().update(static_cast<double>(iteration + 1) / static_cast<double>(options.iterations)))
      return SearchTermination::kInterrupted;
  }
  return SearchTermination::kIterations;
}

}  // namespace

void SwarmOptions::validate() const {
  if (particles == 1 || particles == 2)
    throw InputError("search.particles", fmt::format("is {}; must be >= 3, or 0 for the default", particles));
  if (iterations < 1) throw InputError("search.iterations", "is 0; must be >= 1");
  if (swarms < 1) throw InputError("search.swarms", "is 0; must be >= 1");
  if (!(tolerance >= 0.0)) throw InputError("search.tolerance", fmt::format("is {}; must be >= 0", tolerance));
}

SearchResult particle_swarm(BatchEvaluator& evaluator, const SwarmOptions& options) {
  options.validate();
  const std::size_t n = at(evaluator.problem().size());
  const std::size_t particles = options.particles > 0 ? options.particles : std::min<std::size_t>(60, 10 + 2 * n);
  const std::size_t evaluations = evaluator.evaluations().size(), failed = evaluator.failed();
  SearchResult result;
  for (std::size_t number = 1; number <= options.swarms; ++number) {
    result.termination = run_swarm(evaluator, options, particles, number, result);
    const bool stopped =
        result.termination == SearchTermination::kEvaluations || result.termination == SearchTermination::kInterrupted;
    if (stopped || result.values.feasible()) break;
  }
  result.evaluations = evaluator.evaluations().size() - evaluations;
  result.failed = evaluator.failed() - failed;
  return result;
}

}  // namespace veridyn::estimation
