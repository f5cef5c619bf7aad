#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <random>

#include "tests/estimation/recursive/recursive_rows.hpp"
#include "tests/estimation/simulated_regression.hpp"
#include "veridyn/estimation/recursive/recursive_regression.hpp"
#include "veridyn/estimation/regression/regression.hpp"

namespace veridyn::estimation {
namespace {

using testing_support::feed;
using testing_support::kLastDigits;
using testing_support::neighbouring_errors;
using testing_support::relative;
using testing_support::simulate_regression;

TEST(RecursiveRegression, CoversTheTruthAndPredictsItsInnovation) {
  // White errors, forgetting: 95 % intervals hold the truth and innovations over their sigma have unit variance.
  const Eigen::Vector3d truth(0.2, 1.0, -0.5);
  const Eigen::MatrixXd W = neighbouring_errors(3, 0.3);
  int held = 0, white_held = 0, all = 0;
  double squares = 0.0, count = 0.0;
  for (unsigned seed = 0; seed < 150; ++seed) {
    const RegressionData d = simulate_regression(100 + seed, truth, W, {.rows = 3000, .regressor_rho = 0.5}).data;
    RecursiveOptions options{.method = Method::kGtls, .error_covariance = W};
    options.forgetting.lambda = 0.9985;
    RecursiveRegression recursive(d.parameter_names, options);
    for (Eigen::Index k = 0; k < d.rows(); ++k) {
      const auto u = recursive.update(std::span(d.regressors.row(k).data(), 3), d.regressand(k));
      if (k < 1000) continue;
      squares += std::pow(u.innovation / u.innovation_sigma, 2);
      count += 1.0;
    }
    const RegressionEstimate e = recursive.estimate();
    for (Eigen::Index i = 0; i < 3; ++i) {
      held += truth(i) > e.parameters[i].low95 && truth(i) < e.parameters[i].high95;
      white_held += std::abs(truth(i) - e.theta(i)) < 1.96 * std::sqrt(e.covariance_white(i, i));
      ++all;
    }
  }
  // 450 draws at 0.95 (parameters of a run are correlated): three standard errors are 0.03 to 0.05.
  EXPECT_NEAR(static_cast<double>(held) / all, 0.95, 0.04);
  EXPECT_NEAR(static_cast<double>(white_held) / all, 0.95, 0.04);
  EXPECT_NEAR(squares / count, 1.0, 0.02);
}

TEST(RecursiveRegression, CoversTheTruthWhenTheResidualIsColoured) {
  const Eigen::Vector3d truth(0.2, 1.0, -0.5);
  Eigen::MatrixXd W = neighbouring_errors(3, 0.05);
  int held = 0, white_held = 0, all = 0;
  for (unsigned seed = 0; seed < 150; ++seed) {
    const RegressionData d =
        simulate_regression(900 + seed, truth, W, {.rows = 4000, .regressor_rho = 0.95, .error_rho = 0.9}).data;
    RecursiveOptions options{.method = Method::kGtls, .error_covariance = W};
    options.forgetting.lambda = 1.0;
    RecursiveRegression recursive(d.parameter_names, options);
    feed(recursive, d);
    const RegressionEstimate e = recursive.estimate();
    for (Eigen::Index i = 0; i < 3; ++i) {
      const Parameter& p = e.parameters[i];
      held += truth(i) > p.low95 && truth(i) < p.high95;
      white_held += std::abs(truth(i) - p.value) < 1.96 * p.sigma_white;
      ++all;
    }
  }
  EXPECT_NEAR(static_cast<double>(held) / all, 0.95, 0.045);
  EXPECT_LT(static_cast<double>(white_held) / all, 0.75);
}

// Rows weighted by w: V = s2 M^-1 (sum of w^2 x x') M^-1 with M = sum of w x x', written out.
TEST(RecursiveRegression, ErrorBarsOfForgettingLeastSquaresAreTheirClosedForm) {
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(4, 4);
  W(3, 3) = 0.3;
  const RegressionData d =
      simulate_regression(21, Eigen::Vector3d(0.2, 1.0, -0.5), W, {.rows = 500, .regressor_rho = 0.5}).data;
  const double lambda = 0.99;
  RecursiveOptions options{.method = Method::kOls, .covariance = CovarianceKind::kWhite};
  options.forgetting.lambda = lambda;
  RecursiveRegression recursive(d.parameter_names, options);
  feed(recursive, d);
  Eigen::VectorXd w(d.rows());
  for (Eigen::Index k = 0; k < d.rows(); ++k) w(k) = std::pow(lambda, static_cast<double>(d.rows() - 1 - k));
  const Eigen::MatrixXd X = d.regressors;
  const Eigen::Matrix3d inverse = (X.transpose() * w.asDiagonal() * X).inverse();
  const Eigen::Vector3d theta = inverse * (X.transpose() * w.asDiagonal() * d.regressand);
  const Eigen::VectorXd r = d.regressand - X * theta;
  const double s2 = r.dot(w.asDiagonal() * r) / (w.sum() - 3.0);
  const Eigen::Matrix3d V = s2 * inverse * (X.transpose() * w.cwiseAbs2().asDiagonal() * X) * inverse;
  EXPECT_LT(relative(recursive.theta(), theta), kLastDigits);
  EXPECT_LT(relative(recursive.covariance(), V), kLastDigits);
  EXPECT_NEAR(recursive.residual_sd(), std::sqrt(s2), kLastDigits);
}

// Along what is held the variance is that of the bound and nothing else.
TEST(RecursiveRegression, HeldDirectionHasTheBoundThatWasGiven) {
  RecursiveOptions options{.error_covariance = Eigen::MatrixXd::Zero(4, 4), .unexcited_bound = 5.0};
  options.error_covariance(2, 2) = options.error_covariance(3, 3) = 0.01;
  options.covariance = CovarianceKind::kWhite;
  RecursiveRegression recursive({"constant", "deflection", "alpha"}, options);
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 500; ++k) {
    const double alpha = normal(generator);
    recursive.update(std::array{1.0, 0.5, alpha + 0.1 * normal(generator)},
                     1.0 + 2.0 * alpha + 0.1 * normal(generator));
  }
  ASSERT_EQ(recursive.unexcited().cols(), 1);
  // The data show theta0 + theta1/2 only.
  const Eigen::Vector3d held = Eigen::Vector3d(1.0, -2.0, 0.0).normalized();
  const Eigen::Matrix3d P = recursive.covariance();
  EXPECT_NEAR(std::sqrt(held.dot(P * held)), 5.0 / 1.959964, 1e-6);
  const Eigen::Vector3d shown = Eigen::Vector3d(1.0, 0.5, 0.0);
  EXPECT_LT(std::sqrt(shown.dot(P * shown)), 0.05);
  EXPECT_LT(recursive.sigma()(2), 0.05);
}

TEST(RecursiveRegression, CollinearityIsThatOfTheBatch) {
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(5, 5);
  W(4, 4) = 0.1;
  const RegressionData d = simulate_regression(22, Eigen::Vector4d(0.2, 1.0, -0.5, 0.3), W, {.rows = 800}).data;
  RecursiveOptions options{.method = Method::kOls, .covariance = CovarianceKind::kWhite};
  options.forgetting.lambda = 1.0;
  RecursiveRegression recursive(d.parameter_names, options);
  feed(recursive, d);
  const RegressionEstimate tracked = recursive.estimate(), batch = estimate(d, Method::kOls);
  EXPECT_NEAR(tracked.condition_number / batch.condition_number, 1.0, kLastDigits);
  EXPECT_GT(batch.parameters[1].variance_inflation, 1.5);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(tracked.parameters[i].variance_inflation / batch.parameters[i].variance_inflation, 1.0, 1e-8) << i;
}

}  // namespace
}  // namespace veridyn::estimation
