#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace veridyn::estimation {

/// What goes into a computation y = f(x) whose inputs are measured with errors.
///
/// True inputs are uniform on [low, high] with the given correlation (Gaussian copula); low = high is a constant.
/// Errors are N(0, error_covariance), independent of the true values; the measured input is their sum.
struct UncertainInputs {
  std::vector<std::string> names;    ///< n
  Eigen::VectorXd low, high;         ///< n
  Eigen::MatrixXd correlation;       ///< n x n, of the true values
  Eigen::MatrixXd error_covariance;  ///< n x n, positive semidefinite

  /// @throws InputError naming the input that is out of order.
  void validate() const;
};

/// f: n inputs to m outputs. Called from several threads at once; must not keep state.
using InputsToOutputs = std::function<void(const double* x, double* y)>;
/// Jacobian of f at x: m x n.
using InputsToJacobian = std::function<Eigen::MatrixXd(const Eigen::VectorXd& x)>;

/// How many draws, of which coverage.
struct MonteCarloOptions {
  std::size_t draws = 100000;  ///< JCGM 101 recommends 1e6 for two digits of an endpoint; 1e5 gives about 1 %
  std::uint64_t seed = 1;
  double coverage = 0.95;  ///< of the interval, in (0, 1)
  int threads = 0;         ///< 0: as many as the machine has. Results do not depend on it.

  /// @throws InputError naming option, value and rule.
  void validate() const;
};

/// Distribution of the error f(x_true + e) - f(x_true) of one output.
struct ErrorDistribution {
  double low = 0.0, high = 0.0;  ///< [U-, U+], probabilistically symmetric interval (JCGM 101, 5.3.3)
  double sigma = 0.0;            ///< max(|U-|, |U+|) / 1.96 (the normal quantile of `coverage`)
  double mean = 0.0;             ///< what errors of the inputs shift the output by on average
  double sd = 0.0;               ///< plain standard deviation of the draws
  double endpoint_error = 0.0;   ///< half the 95 % interval of an endpoint, from order statistics: more draws lessen it
  std::size_t not_finite = 0;    ///< draws that were left out
};

/// Errors of all outputs.
struct MonteCarloResult {
  std::vector<ErrorDistribution> outputs;
  std::size_t draws = 0;
  double correlation_change = 0.0;  ///< largest entry that the copula's repair changed; see GaussianCopula
  double seconds = 0.0;
};

/// Propagation of distributions (JCGM 101:2008). Draws are made in blocks, each with its own random stream, so that
/// results are the same to the last bit for any number of threads.
/// @throws InputError when inputs or options are out of order.
[[nodiscard]] MonteCarloResult propagate_errors(const UncertainInputs& inputs, std::size_t outputs,
                                                const InputsToOutputs& f, const MonteCarloOptions& options = {});

/// Law of propagation of uncertainty (GUM 5.2), averaged over the operating range: sqrt of the mean of diag(J S J') at
/// `points` true inputs drawn as in `propagate_errors` (0: at the middle of the ranges only).
[[nodiscard]] Eigen::VectorXd linear_error_propagation(const UncertainInputs& inputs, std::size_t outputs,
                                                       const InputsToJacobian& jacobian, std::size_t points = 500,
                                                       std::uint64_t seed = 1);

}  // namespace veridyn::estimation
