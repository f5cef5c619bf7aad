#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "veridyn/core/progress.hpp"

namespace veridyn::estimation {

/// Logarithm of a probability density up to a constant; -infinity (or NaN) where it is zero.
using LogDensity = std::function<double(const Eigen::VectorXd&)>;
/// That of several points at once.
using LogDensities = std::function<void(std::span<const Eigen::VectorXd> points, std::span<double> values)>;

/// A normal distribution near the density sampled, from a linearisation.
struct NormalApproximation {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;  ///< positive definite
};

/// How an ensemble of walkers samples.
struct EnsembleOptions {
  std::size_t walkers = 0;       ///< even; 0: the larger of 32 and twice the dimensions plus two
  std::size_t steps = 4000;      ///< of every walker, at most, the warm-up included
  std::size_t effective = 1000;  ///< independent draws that are wanted of every coordinate
  std::uint64_t seed = 1;

  /// @throws InputError naming option, value and rule.
  void validate(std::size_t dimensions) const;
};

/// Draws of an ensemble, the warm-up left out.
struct EnsembleSample {
  Eigen::MatrixXd draws;        ///< kept steps x walkers (walker fastest) by dimensions
  Eigen::VectorXd log_density;  ///< of each draw
  std::size_t walkers = 0, steps = 0, warm_up = 0;
  Eigen::VectorXd autocorrelation_steps;  ///< by coordinate: steps from one independent draw of a walker to the next
  double acceptance = 0.0;                ///< share of moves
  double effective = 0.0;                 ///< independent draws of the coordinate that has the fewest
  bool converged = false;                 ///< as many as wanted, and the chain is 20 such times long
  bool interrupted = false;
  std::string message;  ///< one sentence
};

/// Samples a density by an ensemble of walkers that move in two halves, each by positions of the other half
/// (Foreman-Mackey et al. 2013, PASP 125:306), so that a half's moves are independent of each other and their densities
/// are asked for at once: the same bits on any number of threads. Moves, at random: differences of two walkers (ter
/// Braak 2006, Stat Comput 16:239), stretches (Goodman & Weare 2010, Comm Appl Math Comp Sci 5:65), and, with `near`,
/// independent draws of a t distribution of ten degrees of freedom around it, which mix quickly where the density is
/// nearly normal.
///
/// The first quarter of the steps is warm-up. It ends when it has as many independent draws as wanted by the
/// autocorrelation of the walkers' mean over walkers (Sokal's window), or after `steps`.
/// @param start  walkers x dimensions, of positive density; see `ensemble_start`
/// @throws InputError when an option is out of order or a walker starts where the density is zero.
[[nodiscard]] EnsembleSample sample_ensemble(const LogDensities& densities, const Eigen::MatrixXd& start,
                                             const std::optional<NormalApproximation>& near,
                                             const EnsembleOptions& options, Progress& progress);

/// Walkers drawn of `near` where the density is positive, each tried closer to the mean until it is.
/// @throws InputError when the density is zero at the mean.
[[nodiscard]] Eigen::MatrixXd ensemble_start(const LogDensity& density, const NormalApproximation& near,
                                             const EnsembleOptions& options);

}  // namespace veridyn::estimation
