#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace veridyn::numerics {

/// Which share of a result's variance each of its inputs causes, when inputs are independent and uniform in [0, 1)
/// (Saltelli et al. 2010, Comput Phys Commun 181:259): first order V(E(y|x_i))/V(y), what is gone when x_i is known,
/// and total order E(V(y|all but x_i))/V(y), what is left when only x_i is not. Their difference is interaction.
struct SensitivityIndex {
  double first = 0.0, total = 0.0;
  /// Interval of the level asked for, from the spread of independent replicates of the sequence (`variance_indices`).
  /// NaN where one replicate alone has results.
  double first_low = 0.0, first_high = 0.0;
  double total_low = 0.0, total_high = 0.0;
};

/// What `variance_indices` found.
struct SensitivityIndices {
  std::vector<SensitivityIndex> inputs;
  double mean = 0.0, variance = 0.0;  ///< of the result
  std::size_t evaluations = 0;
  std::size_t dropped = 0;  ///< rows of which some result was not finite, left out of all sums
};

/// How many evaluations, and of which sequence.
struct SensitivityOptions {
  std::size_t samples = 512;  ///< N; evaluations are N (inputs + 2). A power of two uses the sequence best
  /// R parts of N/R samples, each a Sobol sequence with a random shift of its own. Few: the sequence is better used,
  /// and intervals are wider by Student's factor; at most N/4 are made.
  std::size_t replicates = 16;
  double level = 0.95;     ///< of the intervals
  std::uint64_t seed = 1;  ///< of the shifts
  /// @throws InputError naming option, value and rule.
  void validate() const;
  /// Replicates of the design: as many as wanted, but each of four rows or more, and at least two.
  [[nodiscard]] std::size_t used_replicates() const;
};

/// Points of a Sobol sequence with a random digital shift: rows of `points` x `dimensions` in [0, 1), the same for the
/// same seed. Directions of Joe & Kuo (2008), up to 1000
/// dimensions. @throws InputError for more.
[[nodiscard]] Eigen::MatrixXd sobol_points(std::size_t points, std::size_t dimensions, std::uint64_t seed);
/// The sequence as it is, from the origin on. @throws InputError for more than 1000 dimensions.
[[nodiscard]] Eigen::MatrixXd plain_sobol_points(std::size_t points, std::size_t dimensions);

/// The points at which `variance_indices` needs results: rows of `samples (inputs + 2)` x inputs; first all of A, then
/// all of B, then A with column 0 of B, and so on. Evaluate them in any order, on any number of threads or machines.
[[nodiscard]] Eigen::MatrixXd variance_design(std::size_t inputs, const SensitivityOptions& options);

/// Indices from the results at these points, in their order: first order by Saltelli's, total by Jansen's estimator, as
/// ratios of sums over all rows. Replicates are independent of each other, whatever the sequence does within them, so
/// that their spread gives the intervals (Student's, R - 1 degrees of freedom; L'Ecuyer & Lemieux 2002). A bootstrap
/// over rows takes the rows for independent ones, and its intervals are far too wide.
/// Rows with a result that is not finite (a simulation that could not finish) are left out and counted.
/// @throws InputError when the number of results does not fit, or fewer than two rows are left.
[[nodiscard]] SensitivityIndices variance_indices(const Eigen::VectorXd& results, std::size_t inputs,
                                                  const SensitivityOptions& options);

/// Elementary effects (Morris 1991, Technometrics 33:161; mu* of Campolongo et al. 2007).
struct MorrisEffect {
  double mean = 0.0;      ///< mu: signs may cancel
  double absolute = 0.0;  ///< mu*: mean of the magnitudes
  double sd = 0.0;        ///< sigma: large where the effect depends on the other inputs or is not linear
};

/// Points of `trajectories` random walks on a grid of `levels` (even) in [0, 1]: rows of trajectories (inputs + 1) x
/// inputs, each walk moving one input at a time. @throws InputError when an option is wrong.
[[nodiscard]] Eigen::MatrixXd morris_design(std::size_t inputs, std::size_t trajectories, std::size_t levels,
                                            std::uint64_t seed);
/// Effects of the inputs from the results at these points. Walks with a result that is not finite are left out.
[[nodiscard]] std::vector<MorrisEffect> morris_effects(const Eigen::MatrixXd& design, const Eigen::VectorXd& results);

}  // namespace veridyn::numerics
