#include "veridyn/estimation/uncertainty/monte_carlo.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {
namespace {

UncertainInputs independent(std::vector<std::string> names, const Eigen::VectorXd& low, const Eigen::VectorXd& high,
                            const Eigen::VectorXd& sigma) {
  const auto n = static_cast<Eigen::Index>(names.size());
  return {.names = std::move(names),
          .low = low,
          .high = high,
          .correlation = Eigen::MatrixXd::Identity(n, n),
          .error_covariance = sigma.cwiseAbs2().asDiagonal()};
}

TEST(MonteCarlo, GivesTheNormalLawOfALinearFunction) {
  UncertainInputs inputs =
      independent({"a", "b"}, Eigen::Vector2d(-1, 0), Eigen::Vector2d(1, 5), Eigen::Vector2d(0.3, 0.1));
  inputs.error_covariance(0, 1) = inputs.error_covariance(1, 0) = 0.5 * 0.3 * 0.1;
  const auto f = [](const double* x, double* y) { y[0] = 2.0 * x[0] - 3.0 * x[1]; };
  const MonteCarloResult result = propagate_errors(inputs, 1, f);
  const double sigma = std::sqrt(4.0 * 0.09 + 9.0 * 0.01 - 12.0 * 0.015);
  // Standard errors at 1e5 draws: of the deviation 0.22 %, of a 2.5 % quantile sqrt(p(1-p)/N)/density = 0.0084 sigma;
  // four of each.
  EXPECT_NEAR(result.outputs[0].sd, sigma, 4 * 0.0022 * sigma);
  EXPECT_NEAR(result.outputs[0].low, -1.959964 * sigma, 4 * 0.0084 * sigma);
  EXPECT_NEAR(result.outputs[0].high, 1.959964 * sigma, 4 * 0.0084 * sigma);
  EXPECT_NEAR(result.outputs[0].sigma, sigma, 4 * 0.0084 * sigma);
  EXPECT_NEAR(result.outputs[0].endpoint_error, 1.96 * 0.0084 * sigma, 0.25 * 1.96 * 0.0084 * sigma);
  const auto jacobian = [](const Eigen::VectorXd&) { return Eigen::MatrixXd(Eigen::RowVector2d(2.0, -3.0)); };
  EXPECT_NEAR(linear_error_propagation(inputs, 1, jacobian)(0), sigma, 1e-14);
}

// (2 + e)^2 - 4 with e standard normal: its distribution is P(|2 + e| <= s) = Phi(s - 2) - Phi(-s - 2), whose 2.5 and
// 97.5 % points follow by bisection. The linear law (sigma 4, symmetric) is far off.
TEST(MonteCarlo, GivesTheExactIntervalOfASquareWhereTheLinearLawFails) {
  const auto quantile = [](double p) {
    double low = 0.0, high = 10.0;
    for (int i = 0; i < 100; ++i) {
      const double s = 0.5 * (low + high);
      (numerics::normal_cdf(s - 2.0) - numerics::normal_cdf(-s - 2.0) < p ? low : high) = s;
    }
    return low * low - 4.0;
  };
  const Eigen::VectorXd two = Eigen::VectorXd::Constant(1, 2.0);
  const UncertainInputs inputs = independent({"x"}, two, two, Eigen::VectorXd::Ones(1));
  const auto f = [](const double* x, double* y) { y[0] = x[0] * x[0]; };
  const MonteCarloResult result = propagate_errors(inputs, 1, f, {.draws = 400000});
  const ErrorDistribution& e = result.outputs[0];
  // endpoint_error is the half width of the 95 % interval of an endpoint: twice it is four standard errors.
  EXPECT_NEAR(e.low, quantile(0.025), 2.0 * e.endpoint_error);
  EXPECT_NEAR(e.high, quantile(0.975), 2.0 * e.endpoint_error);
  // Of the upper end: 1.96 sqrt(p(1-p)/N)/phi(1.96) dy/ds with dy/ds = 2 * 3.96; itself random, hence a quarter.
  EXPECT_NEAR(e.endpoint_error, 0.0657, 0.25 * 0.0657);
  EXPECT_NEAR(e.mean, 1.0, 4.0 * e.sd / std::sqrt(400000.0));
  EXPECT_GT(e.high, 1.5 * -e.low);
}

TEST(MonteCarlo, AveragesOverTheOperatingRange) {
  // Error of a b with a exact to 0.1 and b uniform on [1, 3]: variance 0.01 E b^2 = 0.01 * 13/3.
  const UncertainInputs inputs =
      independent({"a", "b"}, Eigen::Vector2d(5, 1), Eigen::Vector2d(6, 3), Eigen::Vector2d(0.1, 0.0));
  const auto f = [](const double* x, double* y) { y[0] = x[0] * x[1]; };
  const auto jacobian = [](const Eigen::VectorXd& x) { return Eigen::MatrixXd(Eigen::RowVector2d(x(1), x(0))); };
  const double sigma = 0.1 * std::sqrt(13.0 / 3.0);
  EXPECT_NEAR(propagate_errors(inputs, 1, f).outputs[0].sd, sigma, 0.01 * sigma);
  EXPECT_NEAR(linear_error_propagation(inputs, 1, jacobian, 20000)(0), sigma, 0.01 * sigma);
  EXPECT_NEAR(linear_error_propagation(inputs, 1, jacobian, 0)(0), 0.2, 1e-15);
}

TEST(MonteCarlo, IsTheSameToTheLastBitForAnyNumberOfThreads) {
  const UncertainInputs inputs =
      independent({"a", "b"}, Eigen::Vector2d(0.5, 1), Eigen::Vector2d(1, 2), Eigen::Vector2d(0.1, 0.2));
  const auto f = [](const double* x, double* y) {
    y[0] = std::sin(x[0]) * x[1];
    y[1] = x[1] / x[0];
  };
  const MonteCarloResult one = propagate_errors(inputs, 2, f, {.draws = 10007, .seed = 5, .threads = 1});
  for (const int threads : {2, 3, 7, 100}) {
    const MonteCarloResult many = propagate_errors(inputs, 2, f, {.draws = 10007, .seed = 5, .threads = threads});
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(one.outputs[i].low, many.outputs[i].low);
      EXPECT_EQ(one.outputs[i].high, many.outputs[i].high);
      EXPECT_EQ(one.outputs[i].mean, many.outputs[i].mean);
      EXPECT_EQ(one.outputs[i].sd, many.outputs[i].sd);
    }
  }
  EXPECT_NE(one.outputs[0].low,
            propagate_errors(inputs, 2, f, {.draws = 10007, .seed = 6, .threads = 1}).outputs[0].low);
}

TEST(MonteCarlo, CountsDrawsWithoutAResult) {
  const UncertainInputs inputs =
      independent({"x"}, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1), Eigen::VectorXd::Constant(1, 0.2));
  const auto f = [](const double* x, double* y) { y[0] = std::sqrt(x[0]); };
  // P(x + e < 0) = integral over x of Phi(-x/0.2) = 0.2 (phi(0) - phi(5) + ...) = 0.2 phi(0) up to 1e-6.
  const ErrorDistribution e = propagate_errors(inputs, 1, f).outputs[0];
  const double p = 0.2 / std::sqrt(2.0 * M_PI);
  EXPECT_NEAR(static_cast<double>(e.not_finite), 1e5 * p, 4.0 * std::sqrt(1e5 * p));
  EXPECT_TRUE(std::isfinite(e.low));
}

TEST(MonteCarlo, RefusesInputsThatMakeNoSense) {
  const auto f = [](const double* x, double* y) { y[0] = x[0]; };
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  const auto message = [&](const UncertainInputs& inputs, const MonteCarloOptions& options) -> std::string {
    try {
      static_cast<void>(propagate_errors(inputs, 1, f, options));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const UncertainInputs good = independent({"x"}, 0 * one, one, one);
  EXPECT_EQ(message(independent({"x"}, 2 * one, one, one), {}), "uncertain inputs: range [2, 1] of x is not one");
  UncertainInputs negative = good;
  negative.error_covariance(0, 0) = -1.0;
  EXPECT_EQ(message(negative, {}), "uncertain inputs: error variance -1 of x must be finite and >= 0");
  UncertainInputs unknown =
      independent({"x", "y"}, Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 1), Eigen::Vector2d(1, 1));
  unknown.correlation(1, 0) = std::nan("");
  EXPECT_EQ(message(unknown, {}), "uncertain inputs: correlations of y must lie between -1 and 1");
  unknown.correlation(1, 0) = 0.0;
  unknown.correlation(0, 1) = std::nan("");
  EXPECT_EQ(message(unknown, {}), "uncertain inputs: correlations of x must lie between -1 and 1");
  EXPECT_EQ(message(good, {.draws = 10}), "draws: = 10 must be at least 100");
  EXPECT_EQ(message(good, {.coverage = 1.0}), "coverage: = 1 must be between 0 and 1");
}

}  // namespace
}  // namespace veridyn::estimation
