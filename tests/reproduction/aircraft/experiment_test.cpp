#include "bench/reproduction/aircraft/experiment.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/elevator_flight.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

ExperimentOptions options_of(const std::string& more) {
  return ExperimentOptions::read(Study::parse(fmt::format("{}{}", test::elevator_flight(3), more), "test.toml").root());
}

TEST(Experiment, HasExactRowsAndNoiseOfTheStatedSize) {
  Progress silent;
  const ExperimentOptions o =
      options_of("[experiment]\ncoefficient = \"Cm\"\nrate = 100\nsnr = 20\nregressor_snr = 10\nspans = [5, 55]\n");
  const ExactRows rows = exact_rows(o, silent);
  ASSERT_EQ(rows.regressors.rows(), 5000);
  // The rows are those of the linear model: no stall in this flight.
  EXPECT_LT((rows.regressors * rows.truth - rows.regressand).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(rows.noise_sd(0), 0.0) << "the constant has no noise";

  const estimation::RegressionData noisy = noisy_rows(rows, o, 7);
  const auto ratio_dB = [](const Eigen::VectorXd& exact, const Eigen::VectorXd& measured) {
    return 10.0 * std::log10((exact.array() - exact.mean()).square().mean() / (measured - exact).squaredNorm() *
                             static_cast<double>(exact.size()));
  };
  EXPECT_NEAR(ratio_dB(rows.regressand, noisy.regressand), 20.0, 0.4);  // four standard errors of the variance
  for (Eigen::Index j = 1; j < rows.regressors.cols(); ++j)
    EXPECT_NEAR(ratio_dB(rows.regressors.col(j), noisy.regressors.col(j)), 10.0, 0.4);
  EXPECT_EQ(noisy.regressors, noisy_rows(rows, o, 7).regressors);
  EXPECT_NE(noisy.regressors, noisy_rows(rows, o, 8).regressors);
}

TEST(Experiment, CorrelatesItsNoiseOverTheStatedTime) {
  Progress silent;
  const ExperimentOptions o =
      options_of("[experiment]\ncoefficient = \"CL\"\nrate = 100\nsnr = 20\nnoise_time = 0.1\n");
  const ExactRows rows = exact_rows(o, silent);
  const Eigen::VectorXd e = noisy_rows(rows, o, 1).regressand - rows.regressand;
  const auto n = e.size() - 10;
  // exp(-1) after ten samples; the standard error of a correlation over 6000 samples of 20 each is about 0.03.
  EXPECT_NEAR(e.head(n).dot(e.tail(n)) / e.squaredNorm(), std::exp(-1.0), 0.12);
}

TEST(Experiment, NamesTheKeyThatIsWrong) {
  EXPECT_THROW((void)options_of("[experiment]\ncoefficient = \"CX\"\n"), InputError);
  EXPECT_THROW((void)options_of("[experiment]\ncoefficient = \"CL\"\nrate = 1000\n"), InputError);
  EXPECT_THROW((void)options_of("[experiment]\ncoefficient = \"CL\"\nspans = [5]\n"), InputError);
}

}  // namespace
}  // namespace veridyn::aircraft
