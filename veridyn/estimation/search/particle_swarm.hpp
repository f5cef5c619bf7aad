#pragma once

#include <cstdint>

#include "veridyn/estimation/search/batch_evaluator.hpp"

namespace veridyn::estimation {

/// Options of `particle_swarm`.
struct SwarmOptions {
  std::size_t particles = 0;      ///< 0: 10 + 2 n, at most 60
  std::size_t iterations = 200;   ///< at most, of one swarm
  std::size_t swarms = 1;         ///< at most, one after the other from other points, until one found a feasible point
  bool stop_at_feasible = false;  ///< end with the first iteration that found a feasible point
  std::size_t neighbours = 2;     ///< to each side in the ring from which a particle learns the best
  /// Converged when all particles are within this share of the bounds' distance.
  double tolerance = 1e-6;
  std::uint64_t seed = 1;

  /// @throws InputError naming option, value and rule.
  void validate() const;
};

/// Particle swarm (Kennedy & Eberhart 1995, Proc IEEE ICNN 4:1942) with constriction (Clerc & Kennedy 2002, IEEE Trans
/// Evol Comput 6:58: 0.7298 and 1.49618) and a ring of neighbours (Kennedy & Mendes 2002), from points of a scrambled
/// Sobol sequence:
///
///     v <- 0.7298 v + 1.49618 (r1 (own best - x) + r2 (neighbours' best - x)),   x <- x + v
///
/// A particle that leaves the bounds stops at them. All particles of an iteration are one batch. Bests are compared by
/// `better`: as long as nothing is feasible the swarm minimises the violation.
[[nodiscard]] SearchResult particle_swarm(BatchEvaluator& evaluator, const SwarmOptions& options = {});

}  // namespace veridyn::estimation
