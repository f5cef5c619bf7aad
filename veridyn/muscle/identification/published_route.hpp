#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/output_error/logged_model.hpp"
#include "veridyn/estimation/search/batch_evaluator.hpp"
#include "veridyn/estimation/search/particle_swarm.hpp"
#include "veridyn/estimation/search/pattern_search.hpp"
#include "veridyn/muscle/identification/muscle_parametric_model.hpp"

namespace veridyn::muscle {

/// How the published search goes.
struct PublishedRouteOptions {
  double tolerance = 0.01;  ///< greatest NRMSE that a task may have
  /// Repeated up to `swarms` times until a point holds the tolerance in every task; it need not begin anywhere near.
  estimation::SwarmOptions swarm = {.swarms = 5, .stop_at_feasible = true};
  estimation::PatternOptions pattern = {};
  /// Of swarm and pattern search together; `log` is the checkpoint.
  estimation::EvaluationOptions evaluation = {};

  /// @throws InputError naming option, value and rule.
  void validate() const;
};

/// What the published search found.
struct PublishedRouteResult {
  Eigen::VectorXd theta;      ///< values of the model's unknowns; those that are fixed at their start
  std::vector<double> nrmse;  ///< by task, at theta
  estimation::SearchResult swarm, pattern;
  std::vector<estimation::ModelEvaluation> evaluations;  ///< each of all tasks
  std::size_t resumed = 0;                               ///< of them answered from an earlier run's log
  std::size_t failed = 0;                                ///< of them a task could not be simulated
  std::size_t simulations = 0;
  double seconds = 0.0;  ///< of all evaluations, those of the earlier run included

  /// Whether every task holds the tolerance.
  [[nodiscard]] bool usable() const { return pattern.usable(); }
  /// One sentence for each of the two searches.
  [[nodiscard]] std::string message() const;
};

/// The search of the published method: minimise the sum over tasks of the NRMSE subject to NRMSE_i <= tolerance and the
/// unknowns' bounds, by particle swarm until feasible, then non-uniform pattern search with a Nelder-Mead search step.
/// Knows values only, no derivatives, and takes many times the simulations of least squares with exact sensitivities.
/// Where no swarm finds a feasible point the pattern search goes on from the best one, lessening the violation first.
/// The same bits on any number of threads.
/// @param targets  by segment of `model`: samples x outputs; NaN is a missing value
/// @param responses  simulates in the model's place: a view of it; nullptr: the model itself
/// @throws InputError when an option is out of order, a target has no motion, or the log is of another search.
[[nodiscard]] PublishedRouteResult published_route(const MuscleParametricModel& model,
                                                   std::span<const estimation::RowMatrix> targets,
                                                   const PublishedRouteOptions& options, Progress& progress,
                                                   const estimation::ParametricModel* responses = nullptr);

}  // namespace veridyn::muscle
