#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/muscle/identification/muscle_unknowns.hpp"

namespace veridyn::muscle {

/// How `estimate_from_tasks` searches.
struct TaskEstimateOptions {
  int starts = 3;     ///< searches: from the model's own values, and from the best points of the screening
  int screened = 16;  ///< points of a Sobol sequence within the bounds whose fit is looked at first
  std::uint64_t seed = 1;
  /// Where the first search begins, one value a parameter; empty: at the model's own values.
  Eigen::VectorXd first = {};
  /// Look further, from three times as many points of a screening eight times as long, where the first searches leave a
  /// residual beyond the noise (or, where no noise is stated, one that looks like motion): it may be a local minimum.
  bool search_further = true;
  /// Estimate once more, with noise of first order, where that explains the residual better than white noise (with a
  /// stated noise only).
  bool correlated_noise = true;
  /// @throws InputError naming the option and its rule.
  void validate() const;
};

/// One search.
struct TaskSearch {
  double rms_start = 0.0;  ///< of the residual in standard deviations of the noise, where it began; NaN: diverged
  double cost = 0.0;       ///< negative logarithm of the posterior at its end; NaN: it did not finish
  int steps = 0;
  bool agrees = false;  ///< it ends where the best one does, within a standard deviation of every parameter
  std::string message;
};

/// Share of the prior's variance that the tasks have to remove of an identified parameter.
inline constexpr double kIdentifiedShare = 0.75;
/// Of a weak one; of one that they remove less of, nothing is known but the prior: it is not excited.
inline constexpr double kWeakShareOfPrior = 0.25;

/// An estimate from all tasks at once.
struct TaskEstimate {
  /// The status of a parameter is what the tasks say of it: identified or weak by the share of its prior's variance
  /// that they removed; not excited where they hardly move with it, as much with others, or another search ends outside
  /// its interval with as good a fit.
  estimation::OutputErrorEstimate best;
  std::vector<TaskSearch> searches;  ///< the first is from the model's values
  std::size_t chosen = 0;            ///< of them
  /// Whether another search ends with as good a fit at other values: one within the 95 % region of all parameters
  /// together. What it puts outside its interval is not identifiable.
  bool ambiguous = false;
  Eigen::VectorXd learned;  ///< by parameter: share of the prior's variance that the data removed
  /// Combinations that the tasks leave to the prior, in words: "A max_isometric_force against B max_isometric_force".
  std::vector<std::string> null_directions;
  Eigen::MatrixXd null_vectors;  ///< parameters x directions, in units of the priors' standard deviations, unit length
  double chi_square = 0.0;       ///< of the residual over its freedom; NaN where the noise is not known
  double freedom = 0.0;          ///< measured values less what the parameters took
  double lag1 = 0.0;             ///< autocorrelation of the residual at one sample, the largest of any output
  /// Of the noise from sample to sample, by output, where the estimate takes it for of first order; empty: for white.
  /// `chi_square` is then that of its innovations, and `best` is that of `CorrelatedNoiseModel` but for `predicted`.
  Eigen::VectorXd noise_correlation = {};
  double distance = 0.0;  ///< root mean square of the parameters' changes from their starts, each as a share of it
  estimation::SimulationCount simulations;  ///< of tasks, by all searches
  double seconds = 0.0;

  [[nodiscard]] bool usable() const { return best.usable(); }
};

/// Root mean square of a residual, as a share of the motion's range, that simulations to the default accuracy leave
/// where a recording has no noise at all. (Found: 1e-7 to 3e-6 at the truth, 1e-5 and more at other minima.)
inline constexpr double kIntegrationShare = 3e-6;

/// Priors for unknowns that have none: the standard deviation of a value known only to lie within the bounds, their
/// width over sqrt(12), about the start. Without them noise moves what the tasks do not determine.
[[nodiscard]] std::vector<MuscleUnknown> with_bound_priors(std::vector<MuscleUnknown> unknowns);

/// Output error over all tasks at once with exact sensitivities (`estimation::output_error`), from several starts.
/// Valleys of these fits are long and curved and have minima at the bounds, so each search first fits coarsely (with
/// noise as large as the residual, then less and less), and the best two go on with the noise as it is. Error bars are
/// those of the posterior: with priors, and corrected for autocorrelated residuals.
/// @param measured by segment: samples x outputs, NaN where nothing was measured
/// @param noise standard deviation by output; empty: estimated
[[nodiscard]] TaskEstimate estimate_from_tasks(const estimation::ParametricModel& model,
                                               const std::vector<estimation::RowMatrix>& measured,
                                               const Eigen::VectorXd& noise, const TaskEstimateOptions& options,
                                               Progress& progress);

/// What the tasks say where another search ended: `theta` with its intervals, words and null directions. `search` says
/// how it was found; its simulations are not in the count.
[[nodiscard]] TaskEstimate describe_estimate(const estimation::ParametricModel& model,
                                             const std::vector<estimation::RowMatrix>& measured,
                                             const Eigen::VectorXd& noise, const Eigen::VectorXd& theta,
                                             TaskSearch search, Progress& progress);

}  // namespace veridyn::muscle
