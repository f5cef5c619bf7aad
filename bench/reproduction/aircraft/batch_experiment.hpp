#pragma once

#include <string>
#include <vector>

#include "bench/reproduction/aircraft/experiment.hpp"
#include "veridyn/estimation/regression/regression.hpp"

namespace veridyn::aircraft {

/// What one method did over all seeds of an experiment.
struct BatchStatistics {
  estimation::Method method = estimation::Method::kOls;
  int estimates = 0;             ///< seeds that gave an estimate
  Eigen::VectorXd mean, sd;      ///< of the parameters over seeds
  Eigen::VectorXd mean_sigma;    ///< root mean square of the standard errors that the method stated
  Eigen::VectorXd coverage;      ///< interval coverage: share of 95 % intervals that contain the truth
  Eigen::VectorXd output_error;  ///< per seed: largest |z_true - X_true theta| / max |z_true|; NaN without an estimate
  std::vector<double> example;   ///< X_true theta of the first seed

  /// |mean - truth| in units of the scatter of one estimate.
  [[nodiscard]] double bias(Eigen::Index parameter, const Eigen::VectorXd& truth) const;
};

/// All methods over all seeds.
struct BatchExperiment {
  ExactRows rows;
  std::vector<BatchStatistics> methods;
  bool interrupted = false;
};

/// Estimates the parameters once a seed with every method, on the same noise, with the error bars that `identify` gives
/// by default: they allow for autocorrelation, whether the noise has any or not.
[[nodiscard]] BatchExperiment run_batch_experiment(const ExperimentOptions& options,
                                                   const std::vector<estimation::Method>& methods, Progress& progress);

}  // namespace veridyn::aircraft
