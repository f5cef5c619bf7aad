#include "veridyn/estimation/regression/bootstrap.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <atomic>
#include <chrono>
#include <random>
#include <thread>

#include "tests/estimation/simulated_regression.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::estimation {
namespace {

using Eigen::Index;
using testing_support::correlated_noise;

RegressionData rows_with(unsigned seed, double regressor_rho, double error_rho, Index N = 3000) {
  std::mt19937_64 generator(seed);
  RegressionData data;
  data.regressors.resize(N, 3);
  data.regressors.col(0).setOnes();
  data.regressors.col(1) = correlated_noise(generator, N, regressor_rho);
  data.regressors.col(2) = 0.5 * data.regressors.col(1) + correlated_noise(generator, N, regressor_rho);
  data.regressand = data.regressors * Eigen::Vector3d(1.0, -0.5, 0.3) + correlated_noise(generator, N, error_rho);
  data.parameter_names = {"c", "a", "b"};
  data.segment.assign(static_cast<std::size_t>(N), 0);
  std::fill(data.segment.begin() + N / 3, data.segment.end(), 1);
  return data;
}

TEST(BlockBootstrap, AgreesWithTheAnalyticCovarianceForWhiteResiduals) {
  const RegressionData data = rows_with(1, 0.8, 0.0);
  const Bootstrap b = block_bootstrap(data, point_estimator(Method::kOls), {.replicates = 1000});
  ASSERT_TRUE(b.usable()) << b.message;
  // Standard error of a standard deviation from 1000 replicates is 2.2 %; four of these, and 3 % since the true
  // residual power is not the sample's.
  const RegressionEstimate ols = estimate(data, Method::kOls, {.covariance = CovarianceKind::kWhite});
  for (Index j = 0; j < 3; ++j) {
    const double sigma = ols.parameters[j].sigma;
    EXPECT_NEAR(b.sigma(j) / sigma, 1.0, 0.12) << j;
    EXPECT_NEAR(b.high95(j) - b.low95(j), 2.0 * 1.96 * sigma, 0.15 * 2.0 * 1.96 * sigma);
    EXPECT_NEAR(b.mean(j), ols.theta(j), 0.2 * sigma);
  }
}

TEST(BlockBootstrap, AgreesWithTheTrueCovarianceForColouredResiduals) {
  // X and residual AR(1) with 0.9 and 0.8: scores of column 1 are AR(1) with 0.72, so the variance is (1 + 0.72)/(1 -
  // 0.72) = 6.1 times that of white residuals: sigma 2.48 times. Averaged over seeds; blocks of finite length lose
  // some.
  double ratio = 0.0;
  const int seeds = 6;
  for (unsigned seed = 0; seed < seeds; ++seed) {
    const RegressionData data = rows_with(10 + seed, 0.9, 0.8, 4000);
    const Bootstrap b = block_bootstrap(data, point_estimator(Method::kOls), {.replicates = 300, .seed = seed});
    ASSERT_TRUE(b.usable());
    const RegressionEstimate white = estimate(data, Method::kOls, {.covariance = CovarianceKind::kWhite});
    ratio += b.sigma(2) / white.parameters[2].sigma / seeds;
  }
  EXPECT_NEAR(ratio, std::sqrt(1.72 / 0.28), 0.12 * std::sqrt(1.72 / 0.28));
}

TEST(BlockBootstrap, SingleRowsMissTheColour) {
  const RegressionData data = rows_with(20, 0.9, 0.8, 4000);
  const auto sigma = [&](Index block) {
    return block_bootstrap(data, point_estimator(Method::kOls), {.replicates = 300, .block_length = block}).sigma(2);
  };
  EXPECT_GT(sigma(40), 1.7 * sigma(1));
}

TEST(BlockBootstrap, GivesTheSameBitsOnAnyNumberOfThreads) {
  const RegressionData data = rows_with(2, 0.9, 0.5, 600);
  const auto run = [&](int threads) {
    return block_bootstrap(data, point_estimator(Method::kOls), {.replicates = 100, .seed = 5, .threads = threads});
  };
  const Bootstrap one = run(1);
  EXPECT_EQ(one.replicates, run(2).replicates);
  EXPECT_EQ(one.replicates, run(7).replicates);
  const Bootstrap other =
      block_bootstrap(data, point_estimator(Method::kOls), {.replicates = 100, .seed = 6, .threads = 1});
  EXPECT_NE(one.replicates, other.replicates);
}

TEST(BlockBootstrap, UsesTheThreadsOfItsProgress) {
  struct OneThread : Progress {
    [[nodiscard]] int threads() const override { return 1; }
  } progress;
  const auto caller = std::this_thread::get_id();
  std::atomic<int> elsewhere = 0;
  const PointEstimator look = [&](const RegressionData&) -> std::optional<Eigen::VectorXd> {
    if (std::this_thread::get_id() != caller) ++elsewhere;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return Eigen::VectorXd::Zero(3);
  };
  const RegressionData data = rows_with(2, 0.9, 0.5, 600);
  static_cast<void>(block_bootstrap(data, look, {.replicates = 60}, progress));
  EXPECT_EQ(elsewhere, 0);
  static_cast<void>(block_bootstrap(data, look, {.replicates = 60, .threads = 2}, progress));
  EXPECT_GT(elsewhere, 0);
}

TEST(BlockBootstrap, MovesBlocksInsideTheirSegmentsOnly) {
  // Rows carry their own number; every block of the resampled data must be consecutive numbers of one segment.
  RegressionData data = rows_with(3, 0.5, 0.0, 90);
  for (Index k = 0; k < 90; ++k) data.regressand(k) = static_cast<double>(k);
  for (const bool circular : {true, false}) {
    int wrapped = 0;
    const PointEstimator look = [&](const RegressionData& drawn) -> std::optional<Eigen::VectorXd> {
      EXPECT_EQ(drawn.rows(), 90);
      for (Index k = 1; k < 90; ++k) {
        if (drawn.segment[k] != drawn.segment[k - 1]) continue;
        const double before = drawn.regressand(k - 1), now = drawn.regressand(k);
        EXPECT_EQ(before < 30.0, now < 30.0);
        if (now != before + 1.0) {
          ++wrapped;
          EXPECT_EQ(before, before < 30.0 ? 29.0 : 89.0);
          EXPECT_EQ(now, now < 30.0 ? 0.0 : 30.0);
        }
      }
      return Eigen::VectorXd::Zero(3);
    };
    static_cast<void>(
        block_bootstrap(data, look, {.replicates = 50, .block_length = 10, .circular = circular, .threads = 1}));
    EXPECT_EQ(wrapped > 0, circular);
  }
}

TEST(BlockBootstrap, WorksOnGtlsToo) {
  const auto simulated = testing_support::simulate_regression(
      8, Eigen::Vector3d(0.5, 1.0, -0.7), Eigen::Vector4d(0.0, 0.2, 0.2, 0.1).asDiagonal(), {.rows = 3000});
  const Bootstrap b = block_bootstrap(simulated.data, point_estimator(Method::kGtls), {.replicates = 400});
  const RegressionEstimate gtls = estimate(simulated.data, Method::kGtls, {.covariance = CovarianceKind::kWhite});
  ASSERT_TRUE(b.usable());
  for (Index j = 1; j < 3; ++j) {
    EXPECT_NEAR(b.sigma(j) / gtls.parameters[j].sigma, 1.0, 0.2);
    EXPECT_NEAR(b.mean(j), gtls.theta(j), gtls.parameters[j].sigma);
  }
}

TEST(BlockBootstrap, SaysHowOftenTheEstimatorFailed) {
  const RegressionData data = rows_with(2, 0.9, 0.5, 100);
  const Bootstrap never =
      block_bootstrap(data, [](const RegressionData&) { return std::optional<Eigen::VectorXd>(); }, {.replicates = 60});
  EXPECT_FALSE(never.usable());
  EXPECT_EQ(never.failed, 60u);
  EXPECT_EQ(never.message, "the estimator failed on every resampled data set");
  EXPECT_THROW(static_cast<void>(block_bootstrap(data, point_estimator(Method::kOls), {.replicates = 10})), InputError);
}

TEST(PolitisWhiteBlockLength, GrowsWithTheCorrelationAsItsFormulaSays) {
  // AR(1): G = 2 rho/(1 - rho)^2 and g = (1 + rho)/(1 - rho) times the variance, so G/g = 2 rho/(1 - rho^2).
  std::mt19937_64 generator(1);
  const Index N = 20000;
  EXPECT_EQ(politis_white_block_length(correlated_noise(generator, N, 0.0)), 1);
  for (const double rho : {0.5, 0.8}) {
    double mean = 0.0;
    for (int i = 0; i < 10; ++i)
      mean += 0.1 * static_cast<double>(politis_white_block_length(correlated_noise(generator, N, rho)));
    const double ratio = 2.0 * rho / (1.0 - rho * rho);
    const double expected = std::cbrt(1.5 * ratio * ratio * static_cast<double>(N));
    EXPECT_NEAR(mean, expected, 0.2 * expected) << rho;
  }
}

}  // namespace
}  // namespace veridyn::estimation
