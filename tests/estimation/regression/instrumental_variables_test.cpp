#include "veridyn/estimation/regression/instrumental_variables.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/estimation/regression/ordinary_least_squares.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::estimation {
namespace {

/// z = 2 x + 1 + e, where x answers the autocorrelated e (as an aircraft answers gusts) and a known command.
struct FeedbackData {
  RegressionData data;
  RowMatrix instruments;
};

FeedbackData feedback_data(std::uint64_t seed, Eigen::Index n) {
  numerics::RandomStream random(seed, "feedback");
  FeedbackData out;
  out.data.regressors.resize(n, 2);
  out.data.regressand.resize(n);
  out.data.parameter_names = {"slope", "constant"};
  out.instruments.resize(n, 2);
  double e = 0.0, command = 0.0;
  for (Eigen::Index k = 0; k < n; ++k) {
    e = 0.9 * e + random.normal();
    command = 0.8 * command + random.normal();
    const double x = command - 0.5 * e;
    out.data.regressors.row(k) << x, 1.0;
    out.data.regressand(k) = 2.0 * x + 1.0 + e;
    out.instruments.row(k) << command, 1.0;
  }
  return out;
}

TEST(InstrumentalVariables, FindTheSlopeThatLeastSquaresMissesUnderFeedback) {
  const FeedbackData f = feedback_data(1, 5000);
  const InstrumentalEstimate found = instrumental_variables(f.data, f.instruments, 100);
  ASSERT_TRUE(found.usable);
  EXPECT_NEAR(found.theta(0), 2.0, 4.0 * std::sqrt(found.covariance(0, 0)));
  EXPECT_LT(std::sqrt(found.covariance(0, 0)), 0.1);
  EXPECT_LT(estimate(f.data, Method::kOls).theta(0), 1.6) << "least squares is biased here";
}

TEST(InstrumentalVariables, CoverWithAutocorrelatedErrors) {
  int covered = 0;
  constexpr int kRuns = 200;
  for (int i = 0; i < kRuns; ++i) {
    const FeedbackData f = feedback_data(static_cast<std::uint64_t>(100 + i), 1000);
    const InstrumentalEstimate found = instrumental_variables(f.data, f.instruments, 100);
    if (std::abs(found.theta(0) - 2.0) < 1.96 * std::sqrt(found.covariance(0, 0))) ++covered;
  }
  // 95 % of 200 is 190; three standard errors of that count are 9.
  EXPECT_GE(covered, 180);
  EXPECT_LE(covered, 199);
}

TEST(InstrumentalVariables, AreLeastSquaresWhereTheRegressorsAreTheirOwnInstruments) {
  const FeedbackData f = feedback_data(2, 500);
  const InstrumentalEstimate found = instrumental_variables(f.data, f.data.regressors, 50);
  ASSERT_TRUE(found.usable);
  EXPECT_NEAR((found.theta - estimate(f.data, Method::kOls).theta).norm(), 0.0, 1e-10);
}

TEST(InstrumentalVariables, AreNotUsableWhereTheInstrumentsDoNotMoveTheRegressors) {
  FeedbackData f = feedback_data(3, 500);
  for (Eigen::Index k = 0; k < 500; ++k) f.instruments(k, 0) = 2.0;
  EXPECT_FALSE(instrumental_variables(f.data, f.instruments, 50).usable);
  const FeedbackData few = feedback_data(3, 15);
  EXPECT_FALSE(instrumental_variables(few.data, few.instruments, 5).usable);
}

}  // namespace
}  // namespace veridyn::estimation
