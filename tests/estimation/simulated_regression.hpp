#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/numerics/filters.hpp"

namespace veridyn::estimation::testing_support {

/// Unit-variance noise: AR(1) with coefficient `rho`, then (with `pass_Hz` > 0 at 100 Hz) low-passed as a recorded
/// channel is.
inline Eigen::VectorXd correlated_noise(std::mt19937_64& generator, Eigen::Index count, double rho,
                                        double pass_Hz = 0.0) {
  std::normal_distribution<double> normal;
  constexpr Eigen::Index kLeadIn = 200;
  std::vector<double> x(static_cast<std::size_t>(count + 2 * kLeadIn));
  double state = normal(generator);
  for (double& v : x) {
    state = rho * state + std::sqrt(1.0 - rho * rho) * normal(generator);
    v = state;
  }
  if (pass_Hz > 0.0) {
    const auto kernel = numerics::low_pass({.rate_Hz = 100.0, .pass_Hz = pass_Hz, .stop_Hz = 1.5 * pass_Hz});
    x = numerics::filter(x, kernel);
    // Only for white input is this the output's variance; the tests filter white noise.
    const double sd = std::sqrt(kernel.noise_gain());
    for (double& v : x) v /= sd;
  }
  return Eigen::Map<const Eigen::VectorXd>(x.data() + kLeadIn, count);
}

/// z = X theta with a constant and correlated regressors, errors of covariance W on [X, z].
struct SimulatedRegression {
  RegressionData data;
  RowMatrix true_regressors;
  Eigen::VectorXd true_regressand;
};

struct SimulationSettings {
  Eigen::Index rows = 2000;
  double regressor_rho = 0.9;  ///< colour of the true regressors
  double error_rho = 0.0;
  double error_pass_Hz = 0.0;
};

inline SimulatedRegression simulate_regression(unsigned seed, const Eigen::VectorXd& theta, const Eigen::MatrixXd& W,
                                               const SimulationSettings& settings = {}) {
  std::mt19937_64 generator(seed);
  const Eigen::Index n = theta.size(), N = settings.rows;
  SimulatedRegression s;
  s.true_regressors.resize(N, n);
  s.true_regressors.col(0).setOnes();
  for (Eigen::Index j = 1; j < n; ++j)
    s.true_regressors.col(j) = correlated_noise(generator, N, settings.regressor_rho);
  if (n > 2) s.true_regressors.col(2) = (0.8 * s.true_regressors.col(2) + 0.6 * s.true_regressors.col(1)).eval();
  s.true_regressand = s.true_regressors * theta;
  Eigen::MatrixXd errors(N, n + 1);
  for (Eigen::Index j = 0; j <= n; ++j)
    errors.col(j) = correlated_noise(generator, N, settings.error_rho, settings.error_pass_Hz);
  // Pivoted square root: W may be singular.
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(W);
  const Eigen::MatrixXd lower = ldlt.matrixL();
  const Eigen::MatrixXd root = ldlt.transpositionsP().transpose() *
                               (lower * ldlt.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal().toDenseMatrix());
  errors = (errors * root.transpose()).eval();
  s.data.regressors = s.true_regressors + errors.leftCols(n);
  s.data.regressors.col(0).setOnes();
  s.data.regressand = s.true_regressand + errors.col(n);
  s.data.error_covariance = W;
  for (Eigen::Index j = 0; j < n; ++j) s.data.parameter_names.push_back("theta" + std::to_string(j));
  return s;
}

}  // namespace veridyn::estimation::testing_support
