#include "veridyn/estimation/regression/pca_total_least_squares.hpp"

#include "tests/estimation/simulated_regression.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/regression/regression.hpp"

namespace {
using namespace veridyn::estimation;
using testing_support::simulate_regression;
using testing_support::SimulatedRegression;

Eigen::VectorXd true_theta() {
  Eigen::VectorXd theta(4);
  theta << 0.5, -0.7, 0.3, -1.2;
  return theta;
}

Eigen::MatrixXd errors(double variance) {
  Eigen::MatrixXd W = variance * Eigen::MatrixXd::Identity(5, 5);
  W(0, 0) = 0.0;
  return W;
}

// Regressor 2 is regressor 1 in truth (as rudder and aileron of a coordinated turn); each is measured with its own
// error.
SimulatedRegression collinear(unsigned seed, Eigen::Index rows = 2000) {
  const Eigen::MatrixXd W = errors(0.02);
  SimulatedRegression s = simulate_regression(seed, true_theta(), W, {.rows = rows});
  const RowMatrix noise = s.data.regressors - s.true_regressors;
  const Eigen::VectorXd error_z = s.data.regressand - s.true_regressand;
  s.true_regressors.col(2) = s.true_regressors.col(1);
  s.true_regressand = s.true_regressors * true_theta();
  s.data.regressors = s.true_regressors + noise;
  s.data.regressand = s.true_regressand + error_z;
  return s;
}

TEST(PcaTotalLeastSquares, IsGtlsWhenEverythingIsExcited) {
  const auto s = simulate_regression(1, true_theta(), errors(0.02));
  const RegressionEstimate pca = estimate(s.data, Method::kPcaGtls), gtls = estimate(s.data, Method::kGtls);
  EXPECT_EQ(pca.excited_directions, 4);
  EXPECT_TRUE(pca.unexcited.empty());
  EXPECT_LT((pca.theta - gtls.theta).norm(), 1e-12);
  EXPECT_LT((pca.covariance - gtls.covariance).norm(), 1e-9 * gtls.covariance.norm());
  EXPECT_NEAR(pca.threshold, 2.0 * std::sqrt(1996.0), 1e-12);
}

TEST(PcaTotalLeastSquares, NamesTheCombinationThatWasNotExcited) {
  const auto s = collinear(2);
  const RegressionEstimate e = estimate(s.data, Method::kPcaGtls);
  ASSERT_TRUE(e.usable());
  ASSERT_EQ(e.unexcited.size(), 1U);
  EXPECT_EQ(e.excited_directions, 3);
  const Eigen::VectorXd& q = e.unexcited[0].combination;
  EXPECT_NEAR(std::abs(q(1)), std::sqrt(0.5), 0.02);
  EXPECT_NEAR(q(1) + q(2), 0.0, 0.03);
  EXPECT_THAT(e.unexcited[0].text, testing::MatchesRegex("0.7[0-9] theta[12] - 0.7[0-9] theta[12]"));
  EXPECT_EQ(e.parameters[1].status, ParameterStatus::kNotExcited);
  EXPECT_EQ(e.parameters[2].status, ParameterStatus::kNotExcited);
  EXPECT_EQ(e.parameters[3].status, ParameterStatus::kIdentified);
  // Never a small error bar: at least the bound's share.
  for (const std::size_t i : {1U, 2U}) EXPECT_GT(e.parameters[i].sigma, 0.65 * 10.0 / 1.96);
  EXPECT_LT(e.parameters[3].sigma, 0.02);
}

// Of all pairs with sum -0.4 the smallest is (-0.2, -0.2).
TEST(PcaTotalLeastSquares, TakesTheSolutionNearestToThePrior) {
  const auto s = collinear(3, 20000);
  const RegressionEstimate smallest = estimate(s.data, Method::kPcaGtls);
  EXPECT_NEAR(smallest.theta(1), -0.2, 0.02);
  EXPECT_NEAR(smallest.theta(2), -0.2, 0.02);
  RegressionOptions options;
  options.prior = Eigen::VectorXd::Zero(4);
  options.prior(1) = -0.7;  // what is known of it: then the other follows
  options.prior_weight = Eigen::VectorXd::Ones(4);
  options.prior_weight(1) = 1e6;
  const RegressionEstimate informed = estimate(s.data, Method::kPcaGtls, options);
  EXPECT_NEAR(informed.theta(1), -0.7, 1e-3);
  EXPECT_NEAR(informed.theta(2), 0.3, 0.02);
}

TEST(PcaTotalLeastSquares, PinsAParameterOfInfiniteWeight) {
  const auto s = collinear(4);
  RegressionOptions options;
  options.prior = Eigen::VectorXd::Zero(4);
  options.prior(1) = -0.7;
  options.prior_weight = Eigen::VectorXd::Ones(4);
  options.prior_weight(1) = std::numeric_limits<double>::infinity();
  const RegressionEstimate e = estimate(s.data, Method::kPcaGtls, options);
  ASSERT_TRUE(e.usable());
  EXPECT_EQ(e.theta(1), -0.7);
  EXPECT_EQ(e.parameters[1].status, ParameterStatus::kFixed);
  EXPECT_EQ(e.parameters[1].sigma, 0.0);
  EXPECT_TRUE(e.unexcited.empty());

  // The same by hand: z + 0.7 x1 on the other columns, with the errors that it then has.
  RegressionData moved = s.data;
  moved.regressors.resize(s.data.rows(), 3);
  moved.regressors << s.data.regressors.col(0), s.data.regressors.rightCols(2);
  moved.regressand = s.data.regressand + 0.7 * s.data.regressors.col(1);
  moved.parameter_names = {"theta0", "theta2", "theta3"};
  moved.error_covariance = 0.02 * Eigen::MatrixXd::Identity(4, 4);
  moved.error_covariance(0, 0) = 0.0;
  moved.error_covariance(3, 3) = 0.02 * (1.0 + 0.49);
  const RegressionEstimate expected = estimate(moved, Method::kGtls);
  EXPECT_NEAR(e.theta(2), expected.theta(1), 1e-11);
  EXPECT_NEAR(e.theta(3), expected.theta(2), 1e-11);
  EXPECT_NEAR(e.parameters[2].sigma_white / expected.parameters[1].sigma_white, 1.0, 1e-3);
}

// Scaling columns with their errors and weights is a change of units only: thresholds are in units of the errors.
TEST(PcaTotalLeastSquares, JudgesExcitationInUnitsOfTheErrors) {
  const auto s = collinear(5);
  RegressionData scaled = s.data;
  Eigen::VectorXd unit(5);
  unit << 1.0, 1e-3, 40.0, 57.3, 0.1;
  scaled.regressors = s.data.regressors * unit.head(4).asDiagonal();
  scaled.regressand *= unit(4);
  scaled.error_covariance = unit.asDiagonal() * s.data.error_covariance * unit.asDiagonal();
  RegressionOptions options;
  options.prior_weight = unit.head(4) / unit(4);
  const RegressionEstimate before = estimate(s.data, Method::kPcaGtls),
                           after = estimate(scaled, Method::kPcaGtls, options);
  EXPECT_EQ(after.unexcited.size(), before.unexcited.size());
  for (Eigen::Index i = 0; i < 4; ++i) EXPECT_NEAR(after.theta(i) * unit(i) / unit(4), before.theta(i), 1e-9);
}

TEST(PcaTotalLeastSquares, HandlesDependentExactRegressors) {
  auto s = simulate_regression(6, true_theta(), errors(0.02));
  s.data.regressors.col(1).setConstant(2.0);  // exact and twice the constant
  s.data.regressand = s.true_regressand - s.true_regressors.col(1) * true_theta()(1);
  s.data.error_covariance.row(1).setZero();
  s.data.error_covariance.col(1).setZero();
  EXPECT_EQ(estimate(s.data, Method::kGtls).termination, EstimateTermination::kRankDeficient);
  const RegressionEstimate e = estimate(s.data, Method::kPcaGtls);
  ASSERT_TRUE(e.usable());
  ASSERT_EQ(e.unexcited.size(), 1U);
  EXPECT_NEAR(e.unexcited[0].combination(0) / e.unexcited[0].combination(1), -2.0, 1e-6);
  EXPECT_NEAR(e.theta(0) + 2.0 * e.theta(1), 0.5, 0.05);
}

TEST(PcaTotalLeastSquares, ExcitedPartKeepsItsCoverage) {
  double covered[2] = {0.0, 0.0}, covered_parameter = 0.0;
  const int runs = 200;
  for (int m = 0; m < runs; ++m) {
    const auto s = collinear(static_cast<unsigned>(100 + m));
    const RegressionEstimate e = estimate(s.data, Method::kPcaGtls);
    ASSERT_EQ(e.unexcited.size(), 1U);
    const Parameter& p = e.parameters[3];
    covered_parameter += p.low95 < -1.2 && -1.2 < p.high95 ? 1.0 : 0.0;
    // Combinations orthogonal to the direction that was not excited are free of its bound: theta1 + theta2 and theta3,
    // nearly.
    const Eigen::VectorXd& q = e.unexcited[0].combination;
    for (int i = 0; i < 2; ++i) {
      Eigen::VectorXd v = Eigen::VectorXd::Zero(4);
      if (i == 0) {
        v(1) = v(2) = 1.0;
      } else {
        v(3) = 1.0;
      }
      v -= q * q.dot(v);
      const double error = v.dot(true_theta() - e.theta);
      covered[i] += std::abs(error) < 1.96 * std::sqrt(v.dot(e.covariance * v)) ? 1.0 : 0.0;
    }
  }
  // Two and a half standard errors of a share over 200 runs.
  EXPECT_NEAR(covered[0] / runs, 0.95, 0.04);
  EXPECT_NEAR(covered[1] / runs, 0.95, 0.04);
  // theta3 itself has a trace of the bound in its error bar: too wide, never too narrow.
  EXPECT_GE(covered_parameter / runs, 0.95);
}

TEST(RegressionOptions, NameWhatIsWrong) {
  const auto s = simulate_regression(1, true_theta(), errors(0.02), {.rows = 100});
  const auto message = [&](const RegressionOptions& options) {
    try {
      (void)estimate(s.data, Method::kPcaGtls, options);
    } catch (const veridyn::InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(message({.signal_to_noise = 0.5}),
              testing::HasSubstr("regression.signal_to_noise: is 0.5; must be in [1, 10]"));
  EXPECT_THAT(message({.significance = 1.0}), testing::HasSubstr("regression.significance"));
  EXPECT_THAT(message({.prior_weight = Eigen::VectorXd::Zero(4)}), testing::HasSubstr("not > 0"));
  EXPECT_THAT(message({.prior = Eigen::VectorXd::Zero(3)}), testing::HasSubstr("has 3 values for 4 parameters"));
}

}  // namespace
