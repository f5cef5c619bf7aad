#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/search/batch_evaluator.hpp"
#include "veridyn/estimation/search/particle_swarm.hpp"
#include "veridyn/estimation/search/pattern_search.hpp"

/// Problems with known answers for the searches.
namespace veridyn::estimation {

inline BlackBoxProblem box(std::string name, Eigen::Index n, double low, double high) {
  BlackBoxProblem p;
  p.name = std::move(name);
  for (Eigen::Index i = 0; i < n; ++i) p.names.push_back("x" + std::to_string(i + 1));
  p.low = Eigen::VectorXd::Constant(n, low);
  p.high = Eigen::VectorXd::Constant(n, high);
  return p;
}

/// Minimum 0 at (1, ..., 1).
inline BlackBoxProblem rosenbrock(Eigen::Index n) {
  BlackBoxProblem p = box("Rosenbrock", n, -2.0, 2.0);
  p.evaluate = [](const Eigen::VectorXd& x) {
    SearchValues v{.objective = 0.0};
    for (Eigen::Index i = 0; i + 1 < x.size(); ++i)
      v.objective += 100.0 * std::pow(x(i + 1) - x(i) * x(i), 2) + std::pow(1.0 - x(i), 2);
    return v;
  };
  return p;
}

/// Minimum 0 at 0.7 among 11^n or so local ones.
inline BlackBoxProblem rastrigin(Eigen::Index n) {
  BlackBoxProblem p = box("Rastrigin", n, -5.12, 5.12);
  p.evaluate = [](const Eigen::VectorXd& x) {
    SearchValues v{.objective = 0.0};
    for (const double c : x) v.objective += 10.0 + std::pow(c - 0.7, 2) - 10.0 * std::cos(2.0 * kPi * (c - 0.7));
    return v;
  };
  return p;
}

/// Least x + y on the disc x^2 + y^2 <= 2, y >= x - 1: -2 at (-1, -1), where the first constraint holds with equality.
/// Nothing can be computed where x > 1.5.
inline BlackBoxProblem disc() {
  BlackBoxProblem p = box("disc", 2, -2.0, 2.0);
  p.constraint_names = {"disc", "half plane"};
  p.evaluate = [](const Eigen::VectorXd& x) {
    const double nan = x(0) > 1.5 ? std::numeric_limits<double>::quiet_NaN() : 0.0;
    return SearchValues{.objective = x(0) + x(1) + nan, .constraints = {x.squaredNorm() - 2.0, x(0) - x(1) - 1.0}};
  };
  return p;
}

/// A progress that allows so many threads and stops the work after so many looks at it.
class CountingProgress : public Progress {
 public:
  explicit CountingProgress(int threads = 1, long looks = std::numeric_limits<long>::max())
      : threads_(threads), looks_(looks) {}
  [[nodiscard]] bool update(double) override { return !interrupted(); }
  [[nodiscard]] bool interrupted() const override { return --looks_ < 0; }
  [[nodiscard]] int threads() const override { return threads_; }

 private:
  int threads_;
  mutable long looks_;
};

/// Swarm, then pattern search from its best: the way of the published route.
inline SearchResult both(BatchEvaluator& evaluator) {
  const SearchResult start = particle_swarm(evaluator, {.particles = 12, .iterations = 15});
  if (start.termination == SearchTermination::kInterrupted) return start;
  return pattern_search(evaluator, start.x, {.tolerance = 1e-4});
}

}  // namespace veridyn::estimation
