#include "veridyn/estimation/regression/regression_analysis.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <limits>

#include "tests/estimation/regression/correlated_errors.hpp"
#include "tests/estimation/simulated_regression.hpp"

namespace veridyn::estimation {
namespace {

using testing_support::correlated_errors;
using testing_support::true_parameters;

TEST(RegressionAnalysis, DividesRowsByTheirScale) {
  RegressionData data =
      testing_support::simulate_regression(31, true_parameters(), correlated_errors(0.1), {.rows = 300}).data;
  data.row_scale = Eigen::VectorXd::LinSpaced(300, 0.5, 3.0);
  const RegressionOptions options{.covariance = CovarianceKind::kWhite};
  const RegressionEstimate e = internal::RegressionAnalysis(data, options).run(Method::kOls);
  const Eigen::VectorXd weight = data.row_scale.cwiseInverse();
  const Eigen::MatrixXd X = weight.asDiagonal() * data.regressors;
  const Eigen::VectorXd z = weight.cwiseProduct(data.regressand);
  const Eigen::VectorXd theta = X.colPivHouseholderQr().solve(z);
  EXPECT_LT((e.theta - theta).norm(), 1e-11);
  const Eigen::MatrixXd V = (z - X * theta).squaredNorm() / 296.0 * (X.transpose() * X).inverse();
  EXPECT_LT((e.covariance - V).norm(), 1e-10 * V.norm());
}

TEST(RegressionAnalysis, UnderAnotherErrorCovarianceItIsTheEstimateOfThatOne) {
  const RegressionData data =
      testing_support::simulate_regression(32, true_parameters(), correlated_errors(0.1), {.rows = 800}).data;
  RegressionData other = data;
  other.error_covariance = correlated_errors(0.3);
  const RegressionOptions options;
  const auto theta = internal::RegressionAnalysis(data, options).theta_under(Method::kGtls, other.error_covariance);
  ASSERT_TRUE(theta.has_value());
  EXPECT_LT((*theta - estimate(other, Method::kGtls).theta).norm(), 1e-11);
  EXPECT_GT((*theta - estimate(data, Method::kGtls).theta).norm(), 1e-3) << "the difference must show";
}

// Total least squares knows no sizes of errors, only where there are any.
TEST(RegressionAnalysis, TotalLeastSquaresTakesEqualErrorsWhereThereAreAny) {
  const RegressionData data =
      testing_support::simulate_regression(33, true_parameters(), correlated_errors(0.1), {.rows = 200}).data;
  const RegressionOptions options;
  const internal::RegressionAnalysis analysis(data, options);
  Eigen::MatrixXd equal = Eigen::MatrixXd::Identity(5, 5);
  equal(0, 0) = 0.0;
  EXPECT_EQ(analysis.error_covariance(Method::kTls), equal);
  EXPECT_EQ(analysis.error_covariance(Method::kGtls), data.error_covariance);
  // Without any, a column that does not change has none.
  RegressionData unknown = data;
  unknown.error_covariance.resize(0, 0);
  EXPECT_EQ(internal::RegressionAnalysis(unknown, options).error_covariance(Method::kTls), equal);
}

}  // namespace
}  // namespace veridyn::estimation
