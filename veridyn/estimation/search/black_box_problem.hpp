#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "veridyn/core/constants.hpp"

namespace veridyn::estimation {

/// What an expensive computation delivers at one point. NaN anywhere: it could not be computed there.
struct SearchValues {
  double objective = kNaN;
  std::vector<double> constraints = {};  ///< each holds where it is <= 0

  /// Whether all of it could be computed.
  [[nodiscard]] bool finite() const;
  /// Sum of the squares of the constraints that do not hold; infinite where something is not finite.
  [[nodiscard]] double violation() const;
  [[nodiscard]] bool feasible() const { return violation() == 0.0; }
};

/// The order in which the searches compare points (Deb 2000, Comput Methods Appl Mech Eng 186:311): feasible before
/// infeasible; of two feasible ones the lower objective, of two infeasible ones the lower violation; what could not be
/// computed comes last. Equal ones are not better.
[[nodiscard]] bool better(const SearchValues& a, const SearchValues& b);

/// Minimise an objective within bounds and under constraints, knowing nothing but its values: each of them is a
/// simulation or more, may fail (NaN), and has no derivatives.
struct BlackBoxProblem {
  std::string name = {};                ///< for messages and the log
  std::vector<std::string> names = {};  ///< n, of the parameters
  Eigen::VectorXd low = {}, high = {};  ///< n; low < high
  std::vector<std::string> constraint_names = {};
  /// Called from several threads at once. Its values follow from x alone.
  std::function<SearchValues(const Eigen::VectorXd& x)> evaluate = {};
  /// What else decides the values or the way of the search, as name and value ("tasks", "1 5 9"): a log is continued
  /// only where all of it is the same. No line breaks.
  std::vector<std::pair<std::string, std::string>> identity = {};

  [[nodiscard]] Eigen::Index size() const { return low.size(); }
  /// @throws InputError naming the parameter whose bounds cross or are not finite, or sizes that differ.
  void validate() const;
};

/// Why a search ended.
enum class SearchTermination {
  kConverged,    ///< the mesh, or the swarm, is smaller than its tolerance
  kFeasible,     ///< a point that holds all constraints was found, and no more was asked for
  kIterations,   ///< the largest number of iterations is used up
  kEvaluations,  ///< the largest number of evaluations is used up
  kInterrupted,  ///< the caller's progress asked to stop
};

/// The best point that a search found.
struct SearchResult {
  Eigen::VectorXd x;
  SearchValues values;
  SearchTermination termination = SearchTermination::kIterations;
  std::size_t iterations = 0;
  std::size_t evaluations = 0;  ///< of this search, those from an earlier run's log included
  std::size_t failed = 0;       ///< of them could not be computed

  /// Whether the best point holds all constraints. It need not be a minimum: see `termination`.
  [[nodiscard]] bool usable() const { return values.feasible(); }
  /// One sentence.
  [[nodiscard]] std::string message() const;
};

}  // namespace veridyn::estimation
