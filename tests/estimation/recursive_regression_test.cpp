#include "veridyn/estimation/recursive_regression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "simulated_regression.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/ordinary_least_squares.hpp"
#include "veridyn/estimation/pca_total_least_squares.hpp"
#include "veridyn/estimation/augmented_qr.hpp"

namespace veridyn::estimation {
namespace {

using testing_support::simulate_regression;

constexpr double kLastDigits = 1e-9;

std::vector<std::string> names_of(Eigen::Index n) {
  std::vector<std::string> names;
  for (Eigen::Index i = 0; i < n; ++i) names.push_back("theta" + std::to_string(i));
  return names;
}

Eigen::MatrixXd correlated_errors(Eigen::Index n, double ratio) {
  Eigen::MatrixXd W = ratio * Eigen::MatrixXd::Identity(n + 1, n + 1);
  W.row(0).setZero();
  W.col(0).setZero();
  for (Eigen::Index i = 1; i < n; ++i) W(i, i + 1) = W(i + 1, i) = 0.3 * ratio;
  return W;
}

void feed(RecursiveRegression& recursive, const RegressionData& data) {
  for (Eigen::Index k = 0; k < data.rows(); ++k) {
    const auto result =
        recursive.update(std::span(data.regressors.row(k).data(), static_cast<std::size_t>(data.parameters())),
                         data.regressand(k));
    ASSERT_TRUE(result.accepted);
  }
}

// |a - b| over the largest element: the tolerance is on digits of the whole.
double relative(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

struct Case {
  Method method;
  Eigen::Index n;
};
class RecursiveRegressionOfAnyMethod : public ::testing::TestWithParam<Case> {
 protected:
  static RegressionData data(unsigned seed, Eigen::Index rows = 800) {
    const Eigen::Index n = GetParam().n;
    auto simulated = simulate_regression(seed, Eigen::VectorXd::LinSpaced(n, -1.0, 2.0), correlated_errors(n, 0.02),
                                         {.rows = rows, .regressor_rho = 0.5});
    return simulated.data;
  }
  static RecursiveOptions options(const RegressionData& data, double lambda) {
    RecursiveOptions o;
    o.method = GetParam().method;
    o.forgetting.lambda = lambda;
    o.forgetting.lambda_min = std::min(0.5, lambda);
    o.covariance = CovarianceKind::kWhite;
    o.error_covariance = data.error_covariance;
    return o;
  }
};

TEST_P(RecursiveRegressionOfAnyMethod, IsTheBatchEstimateOfTheSameRowsWhenNothingIsForgotten) {
  const RegressionData d = data(1);
  RecursiveRegression recursive(d.parameter_names, options(d, 1.0));
  feed(recursive, d);
  const RegressionEstimate batch = estimate(d, GetParam().method, {.covariance = CovarianceKind::kWhite});
  ASSERT_TRUE(batch.usable());
  ASSERT_TRUE(recursive.usable());
  EXPECT_LT(relative(recursive.theta(), batch.theta), kLastDigits);
  EXPECT_LT(relative(recursive.covariance(), batch.covariance), kLastDigits);
  EXPECT_EQ(recursive.excited_directions(), d.parameters());
  if (GetParam().method != Method::kOls) {
    EXPECT_NEAR(recursive.error_scale(), batch.error_scale, kLastDigits * batch.error_scale);
    for (std::size_t j = 0; j < batch.singular_values.size(); ++j) {
      EXPECT_NEAR(recursive.singular_values()(static_cast<Eigen::Index>(j)), batch.singular_values[j],
                  kLastDigits * batch.singular_values[j]);
    }
  }
}

TEST_P(RecursiveRegressionOfAnyMethod, IsTheBatchEstimateOfRowsWeightedByTheRootOfLambda) {
  RegressionData d = data(2);
  const double lambda = 0.99;
  RecursiveRegression recursive(d.parameter_names, options(d, lambda));
  feed(recursive, d);
  d.row_scale.resize(d.rows());
  for (Eigen::Index k = 0; k < d.rows(); ++k)
    d.row_scale(k) = std::pow(lambda, -0.5 * static_cast<double>(d.rows() - 1 - k));
  const RegressionEstimate batch = estimate(d, GetParam().method, {.covariance = CovarianceKind::kWhite});
  EXPECT_LT(relative(recursive.theta(), batch.theta), kLastDigits);
  EXPECT_NEAR(recursive.effective_samples(), (1.0 - std::pow(lambda, 800.0)) / (1.0 - lambda), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Methods, RecursiveRegressionOfAnyMethod,
                         ::testing::Values(Case{Method::kOls, 4}, Case{Method::kGtls, 4}, Case{Method::kPcaGtls, 4},
                                           Case{Method::kOls, 7}, Case{Method::kGtls, 7}, Case{Method::kPcaGtls, 7},
                                           Case{Method::kOls, 1}, Case{Method::kGtls, 2}, Case{Method::kGtls, 8}));

TEST(RecursiveRegression, WithUnknownDirectionsIsTheBatchPcaAroundTheEstimateBefore) {
  // theta2 and theta3 hardly move: not excited.
  auto simulated = simulate_regression(3, Eigen::Vector4d(0.2, 1.0, -0.5, 0.3), correlated_errors(4, 0.02), {.rows = 600});
  RegressionData& d = simulated.data;
  d.regressors.rightCols(1) *= 0.05;
  d.regressors.col(2) = d.regressors.col(1) * 0.7 + 0.02 * d.regressors.col(2);
  RecursiveOptions options{.error_covariance = d.error_covariance, .covariance = CovarianceKind::kWhite};
  options.forgetting.lambda = 1.0;
  RecursiveRegression recursive(d.parameter_names, options);
  Eigen::VectorXd before = recursive.theta();
  AugmentedQr qr(5);
  int partial = 0;
  for (Eigen::Index k = 0; k < d.rows(); ++k) {
    Eigen::Matrix<double, 1, 5, Eigen::RowMajor> row;
    row << d.regressors.row(k), d.regressand(k);
    qr.append(row);
    recursive.update(std::span(row.data(), 4), row(4));
    if (k > 100 && k % 50 == 0) {
      const auto batch = pca_total_least_squares(qr.triangle(), d.error_covariance, static_cast<double>(k + 1), 1.0,
                                                 true, before, Eigen::VectorXd::Ones(4));
      ASSERT_EQ(recursive.excited_directions(), batch.excited_directions);
      ASSERT_LT(relative(recursive.theta(), batch.theta), kLastDigits) << k;
      partial += batch.excited_directions < 4 ? 1 : 0;
      ASSERT_EQ(recursive.unexcited().cols(), batch.unexcited.cols());
      // Same subspace.
      const Eigen::MatrixXd U = recursive.unexcited();
      EXPECT_LT((U - batch.unexcited * (batch.unexcited.transpose() * U)).norm(), 1e-8);
    }
    before = recursive.theta();
  }
  EXPECT_GT(partial, 5);
}

}  // namespace
}  // namespace veridyn::estimation
