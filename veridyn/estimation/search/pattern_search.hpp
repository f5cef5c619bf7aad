#pragma once

#include <cstdint>

#include "veridyn/estimation/search/batch_evaluator.hpp"

namespace veridyn::estimation {

/// Options of `pattern_search`.
struct PatternOptions {
  double initial_mesh = 0.1;                ///< first size of the poll, as a share of the bounds' distance
  double tolerance = 1e-6;                  ///< converged when the poll is smaller than this share in every coordinate
  std::size_t iterations = 1000;            ///< at most
  bool nelder_mead = true;                  ///< search step before each poll
  std::size_t nelder_mead_evaluations = 0;  ///< of one search step; 0: 10 (n + 1)
  std::uint64_t seed = 1;                   ///< of the directions

  /// @throws InputError naming option, value and rule.
  void validate() const;
};

/// Pattern search on an adaptive mesh (Audet & Dennis 2006, SIAM J Optim 17:188) that is not uniform: each coordinate
/// has a size of its own (Audet, Le Digabel & Tribes 2016, Comput Optim Appl 64:503).
///
/// An iteration first lets a Nelder-Mead simplex of the best points near the incumbent move. Where that finds nothing
/// better, it polls: 2 n points along an orthogonal basis of random direction (a Householder reflection, Abramson et
/// al. 2009), one batch. Success enlarges the sizes of the coordinates that took part in the step, failure halves all.
/// Steps are multiples of a mesh that shrinks with the square of the sizes, so that directions become dense.
/// Constraints by `better`: from an infeasible start the violation is lessened first, then they are a barrier.
///
/// Converges to a point that no nearby direction improves: a local minimum.
/// @param start  within the bounds; evaluated first
[[nodiscard]] SearchResult pattern_search(BatchEvaluator& evaluator, const Eigen::VectorXd& start,
                                          const PatternOptions& options = {});

}  // namespace veridyn::estimation
