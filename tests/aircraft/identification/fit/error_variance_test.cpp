#include "veridyn/aircraft/identification/fit/error_variance.hpp"

#include <gtest/gtest.h>

#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {
namespace {

/// z = 2 x + noise of standard deviation 0.1, x recorded with an error of `x_error`; further columns as asked.
estimation::RegressionData noisy_line(double x_error, bool with_copy, double signal = 1.0) {
  constexpr Eigen::Index kRows = 20000;
  const Eigen::Index n = with_copy ? 3 : 2;
  estimation::RegressionData data;
  data.regressors.resize(kRows, n);
  data.regressand.resize(kRows);
  numerics::RandomStream random(5, "line");
  for (Eigen::Index i = 0; i < kRows; ++i) {
    const double x = signal * random.normal();
    data.regressors(i, 0) = 1.0;
    data.regressors(i, 1) = x + x_error * random.normal();
    // A term that is never anything but another.
    if (with_copy) data.regressors(i, 2) = data.regressors(i, 1);
    data.regressand(i) = 0.5 + 2.0 * x + 0.1 * random.normal();
  }
  data.error_covariance = Eigen::MatrixXd::Zero(n + 1, n + 1);
  data.error_covariance.block(1, 1, n - 1, n - 1).setConstant(x_error * x_error);
  data.error_covariance(n, n) = 0.01;
  return data;
}

TEST(EquationError, IsTheVarianceThatTheErrorsOfTheRegressorsLeave) {
  EXPECT_NEAR(equation_error(noisy_line(0.2, false)).ratio, 1.0, 0.1);
  estimation::RegressionData doubted = noisy_line(0.2, false);
  doubted.error_covariance(2, 2) = 0.0025;
  EXPECT_NEAR(equation_error(doubted).ratio, 4.0, 0.4);
  EXPECT_NEAR(equation_error(doubted).variance, 0.01, 0.001);
}

// Without the directions that hold signal the equations would be singular, and the ratio whatever rounding makes of it.
TEST(EquationError, IsJudgedWhereTermsMoveTogether) {
  EXPECT_NEAR(equation_error(noisy_line(0.2, true)).ratio, 1.0, 0.1);
}

TEST(EquationError, LeavesAloneARegressorThatIsAllNoise) {
  // 0.01 by the noise of z and 4 * 0.05^2 = 0.01 by the signal, which noise of 1 hides.
  EXPECT_NEAR(equation_error(noisy_line(1.0, false, 0.05)).ratio, 2.0, 0.2);
}

TEST(ResidualRatio, ComparesWithTheErrorsOfRegressorsAndResponse) {
  const estimation::RegressionData data = noisy_line(0.2, false);
  const Eigen::Vector2d right(0.5, 2.0);
  EXPECT_NEAR(residual_ratio(data, right), 1.0, 0.05);
  const Eigen::Vector2d wrong(0.5, 3.0);
  EXPECT_GT(residual_ratio(data, wrong), 2.0);
}

}  // namespace
}  // namespace veridyn::aircraft
