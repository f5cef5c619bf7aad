#pragma once

#include <functional>
#include <vector>

#include "veridyn/estimation/search/batch_evaluator.hpp"

namespace veridyn::estimation {

/// A point with its values.
struct SearchPoint {
  Eigen::VectorXd x;
  SearchValues values;
};

/// Where a simplex came to.
struct SimplexMoves {
  std::vector<SearchPoint> simplex;  ///< best first
  bool completed = true;             ///< false: the evaluator ended
};

/// Moves a simplex of n + 1 points (Nelder & Mead 1965, Comput J 7:308) until it would have to shrink, stands still, or
/// `max_evaluations` new points were tried: reflection 1, expansion 2, contraction 1/2, in the order of `better`.
/// Trial points pass through `snap` (onto a mesh and into the bounds); one that lands on a vertex ends the moves, which
/// is what keeps a simplex from collapsing below the mesh (Audet & Tribes 2018, Comput Optim Appl 71:331).
[[nodiscard]] SimplexMoves move_simplex(BatchEvaluator& evaluator, std::vector<SearchPoint> simplex,
                                        const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& snap,
                                        std::size_t max_evaluations);

}  // namespace veridyn::estimation
