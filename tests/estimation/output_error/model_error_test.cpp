#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "tests/estimation/output_error/example_models.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"

/// `OutputErrorOptions::model_error`: what a model lacks follows the motion, and hides along its parameters.
namespace veridyn::estimation {
namespace {

using namespace testing_support;

constexpr Index kSamples = 2000;
constexpr double kNoise = 0.05;

/// Slow motion: two regressors of unit variance.
RowMatrix motion(std::mt19937_64& generator) {
  RowMatrix X(kSamples, 2);
  for (Index j = 0; j < 2; ++j) {
    X.col(j) = correlated_noise(generator, kSamples, 0.98);
    X.col(j) /= std::sqrt(X.col(j).squaredNorm() / kSamples);
  }
  return X;
}

VectorXd white_noise(std::mt19937_64& generator) {
  std::normal_distribution<double> normal(0.0, kNoise);
  return VectorXd::NullaryExpr(kSamples, [&] { return normal(generator); });
}

OutputErrorEstimate estimated(const RowMatrix& X, const VectorXd& z, bool model_error) {
  OutputErrorOptions options;
  options.model_error = model_error;
  const Static model({{X}});
  return output_error(model, {RowMatrix(z)}, options);
}

TEST(ModelError, AddsNothingWhereTheResidualIsWhite) {
  std::mt19937_64 generator(5);
  int widened = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const RowMatrix X = motion(generator);
    const VectorXd z = X * Eigen::Vector2d(1.0, -0.5) + white_noise(generator);
    const OutputErrorEstimate e = estimated(X, z, true);
    ASSERT_TRUE(e.usable()) << e.message;
    if (e.covariance_by_model(0, 0) > 0.0) ++widened;
    EXPECT_LT(e.covariance_by_model(0, 0), 40.0 * e.covariance(0, 0));
  }
  // Two standard errors: once in forty.
  EXPECT_LE(widened, 5);
}

// A third motion that the model lacks goes half with the first: 0.05 of a slope of one, where white noise leaves 0.001.
// (Not all of an error need show: of a gain that falls as 1 - 0.05 x^2 more is absorbed by the slope than is left, and
// 15 of 40 intervals hold it.)
TEST(ModelError, IsInTheIntervalsWhereAMotionIsMissing) {
  std::mt19937_64 generator(6);
  constexpr int trials = 40;
  int inside = 0, inside_without = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const RowMatrix X = motion(generator);
    const VectorXd missing = 0.5 * X.col(0) + std::sqrt(0.75) * motion(generator).col(0);
    const VectorXd z = X * Eigen::Vector2d(1.0, -0.5) + 0.1 * missing + white_noise(generator);
    for (const bool model_error : {false, true}) {
      const OutputErrorEstimate e = estimated(X, z, model_error);
      ASSERT_TRUE(e.usable()) << e.message;
      const bool holds = e.parameters[0].low95 <= 1.0 && 1.0 <= e.parameters[0].high95;
      (model_error ? inside : inside_without) += holds ? 1 : 0;
    }
  }
  EXPECT_LE(inside_without, trials / 2);
  EXPECT_GE(inside, trials * 9 / 10);
}

/// Noise of variance `share` of which successive values correlate by 0.95, and white noise of the rest.
VectorXd coloured_noise(std::mt19937_64& generator, double share) {
  VectorXd slow = correlated_noise(generator, kSamples, 0.95);
  slow *= kNoise * std::sqrt(share * kSamples / slow.squaredNorm());
  return slow + std::sqrt(1.0 - share) * white_noise(generator);
}

/// What such noise is as one of the inputs.
InputNoise as_input_noise(double share) {
  double later = 0.0;
  for (Index lag = 1; lag <= kColourLags; ++lag) later += std::pow(0.95, lag) / kColourLags;
  const double variance = share * kNoise * kNoise;
  return {.variance = VectorXd::Constant(1, variance),
          .autocovariance = VectorXd::Constant(1, later * variance),
          .memory = VectorXd::Constant(1, 1.95 / 0.05)};
}

// Coloured noise of the inputs is no error of the model; and a sample of it says less than a white one against what is
// known before: of half of the variance with a memory of 39 samples, a twentieth.
TEST(ModelError, DoesNotTakeNoiseOfTheInputsForIt) {
  std::mt19937_64 generator(8);
  constexpr int trials = 40;
  int widened = 0, widened_without = 0;
  double free_sigma = 0.0, known_sigma = 0.0;
  for (int trial = 0; trial < trials; ++trial) {
    const RowMatrix X = motion(generator);
    const VectorXd z = X * Eigen::Vector2d(1.0, -0.5) + coloured_noise(generator, 0.5);
    Static model({{X}});
    OutputErrorOptions options;
    options.model_error = true;
    const OutputErrorEstimate without = output_error(model, {RowMatrix(z)}, options);
    options.input_noise = as_input_noise(0.5);
    const OutputErrorEstimate with = output_error(model, {RowMatrix(z)}, options);
    ASSERT_TRUE(with.usable()) << with.message;
    widened += with.covariance_by_model(0, 0) > 0.0 ? 1 : 0;
    widened_without += without.covariance_by_model(0, 0) > 0.0 ? 1 : 0;
    // A prior with the standard deviation of the estimate without it halves the variance, if both weigh as they should.
    free_sigma += with.parameters[0].sigma / trials;
    model.unknowns[0].start = 1.0;
    model.unknowns[0].prior_sigma = with.parameters[0].sigma;
    known_sigma += output_error(model, {RowMatrix(z)}, options).parameters[0].sigma / trials;
  }
  EXPECT_EQ(widened_without, trials);
  EXPECT_LE(widened, 5);
  EXPECT_NEAR(known_sigma / free_sigma, std::sqrt(0.5), 0.1);
}

// Data that the model does not explain count for less against what is known before.
TEST(ModelError, LetsPriorsCountForMore) {
  std::mt19937_64 generator(7);
  const RowMatrix X = motion(generator);
  VectorXd z = X * Eigen::Vector2d(1.0, -0.5) + white_noise(generator);
  z.array() -= 0.05 * X.col(0).array().cube();
  Static model({{X}});
  model.unknowns[0].start = 1.0;
  model.unknowns[0].prior_sigma = 0.02;
  OutputErrorOptions options;
  const double plain = output_error(model, {RowMatrix(z)}, options).theta(0);
  options.model_error = true;
  const OutputErrorEstimate e = output_error(model, {RowMatrix(z)}, options);
  EXPECT_LT(std::abs(e.theta(0) - 1.0), 0.5 * std::abs(plain - 1.0));
  EXPECT_LE(e.parameters[0].sigma, 0.021);
  EXPECT_GT(e.parameters[0].sigma, 0.01);
}

}  // namespace
}  // namespace veridyn::estimation
