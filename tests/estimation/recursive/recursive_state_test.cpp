#include "veridyn/estimation/recursive/recursive_state.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/estimation/recursive/recursive_rows.hpp"
#include "tests/estimation/simulated_regression.hpp"
#include "veridyn/estimation/regression/augmented_qr.hpp"
#include "veridyn/estimation/regression/pca_total_least_squares.hpp"
#include "veridyn/estimation/regression/regression.hpp"

namespace veridyn::estimation {
namespace {

using testing_support::feed;
using testing_support::kLastDigits;
using testing_support::neighbouring_errors;
using testing_support::relative;
using testing_support::simulate_regression;

struct Case {
  Method method;
  Eigen::Index n;
};

class RecursiveRegressionOfAnyMethod : public ::testing::TestWithParam<Case> {
 protected:
  static RegressionData data(unsigned seed, Eigen::Index rows = 800) {
    const Eigen::Index n = GetParam().n;
    auto simulated = simulate_regression(seed, Eigen::VectorXd::LinSpaced(n, -1.0, 2.0), neighbouring_errors(n, 0.02),
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
      EXPECT_NEAR(recursive.singular_values()(j), batch.singular_values[j], kLastDigits * batch.singular_values[j]);
    }
  }
}

TEST_P(RecursiveRegressionOfAnyMethod, IsTheBatchEstimateOfRowsWeightedByTheRootOfLambda) {
  RegressionData d = data(2);
  const double lambda = 0.998;  // all directions stay excited
  RecursiveRegression recursive(d.parameter_names, options(d, lambda));
  feed(recursive, d);
  d.row_scale.resize(d.rows());
  for (Eigen::Index k = 0; k < d.rows(); ++k)
    d.row_scale(k) = std::pow(lambda, -0.5 * static_cast<double>(d.rows() - 1 - k));
  const RegressionEstimate batch = estimate(d, GetParam().method, {.covariance = CovarianceKind::kWhite});
  EXPECT_LT(relative(recursive.theta(), batch.theta), kLastDigits);
  EXPECT_NEAR(recursive.effective_samples(), (1.0 - std::pow(lambda, 800.0)) / (1.0 - lambda), 1e-8);
}

INSTANTIATE_TEST_SUITE_P(Methods, RecursiveRegressionOfAnyMethod,
                         ::testing::Values(Case{Method::kOls, 4}, Case{Method::kGtls, 4}, Case{Method::kPcaGtls, 4},
                                           Case{Method::kOls, 7}, Case{Method::kGtls, 7}, Case{Method::kPcaGtls, 7},
                                           Case{Method::kOls, 1}, Case{Method::kGtls, 2}, Case{Method::kGtls, 8}));

TEST(RecursiveRegression, WithUnknownDirectionsIsTheBatchPcaAroundTheEstimateBefore) {
  // theta2 and theta3 hardly move: not excited.
  auto simulated =
      simulate_regression(3, Eigen::Vector4d(0.2, 1.0, -0.5, 0.3), neighbouring_errors(4, 0.02), {.rows = 600});
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

// Rows of a and b, one after the other.
RegressionData joined(const RegressionData& a, const RegressionData& b) {
  RegressionData both = a;
  both.regressors.resize(a.rows() + b.rows(), a.parameters());
  both.regressors << a.regressors, b.regressors;
  both.regressand.resize(a.rows() + b.rows());
  both.regressand << a.regressand, b.regressand;
  return both;
}

TEST(RecursiveRegression, StartedFromABatchEstimateIsTheBatchEstimateOfBothRecordings) {
  const Eigen::Vector4d truth(0.2, 1.0, -0.5, 0.3);
  const Eigen::MatrixXd W = neighbouring_errors(4, 0.02);
  const RegressionData first = simulate_regression(5, truth, W, {.rows = 1500}).data;
  const RegressionData second = simulate_regression(6, truth, W, {.rows = 500}).data;
  for (const Method method : {Method::kOls, Method::kGtls, Method::kPcaGtls}) {
    const RegressionOptions white{.covariance = CovarianceKind::kWhite};
    const RegressionEstimate before = estimate(first, method, white);
    const RegressionEstimate both = estimate(joined(first, second), method, white);
    RecursiveOptions options{.method = method, .error_covariance = W, .covariance = CovarianceKind::kWhite};
    options.forgetting.lambda = 1.0;
    RecursiveRegression recursive(first.parameter_names, options);
    const double s = method == Method::kOls ? before.residual_sd : 0.0;
    recursive.start(before.theta, before.covariance, 1500.0, s);
    EXPECT_LT(relative(recursive.theta(), before.theta), 1e-8);
    feed(recursive, second);
    if (method == Method::kOls) {
      // Rows P_0^-1/2 hold X'X and the residual of the first recording exactly.
      EXPECT_LT(relative(recursive.theta(), both.theta), kLastDigits);
      EXPECT_LT(relative(recursive.covariance(), both.covariance), kLastDigits);
    } else {
      // The second-order term of P_0, 2 % here, is taken for less information; the answer differs by far less than its
      // error bar.
      for (Eigen::Index i = 0; i < 4; ++i) {
        const double sigma = std::sqrt(both.covariance(i, i));
        EXPECT_NEAR(recursive.theta()(i), both.theta(i), 0.15 * sigma);
        EXPECT_NEAR(recursive.sigma()(i), sigma, 0.1 * sigma);
      }
      EXPECT_NEAR(recursive.effective_samples(), 2000.0, 1e-9);
    }
  }
}

TEST(RecursiveRegression, RefusesRowsThatAreNotFiniteAndStaysAsItWas) {
  const RegressionData d = simulate_regression(8, Eigen::Vector3d(0.5, 1.0, -1.0), neighbouring_errors(3, 0.01)).data;
  RecursiveRegression recursive(d.parameter_names, {.error_covariance = d.error_covariance});
  feed(recursive, d);
  RecursiveRegression copy = recursive;
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const std::vector<std::array<double, 4>> bad{
      {nan, 1, 1, 1}, {1, inf, 1, 1}, {1, 1, -inf, 1}, {1, 1, 1, nan}, {1, 1e200, 1, 1}};
  for (const auto& row : bad) {
    const auto result = recursive.update(std::span(row.data(), 3), row[3]);
    EXPECT_FALSE(result.accepted);
    EXPECT_TRUE(std::isnan(result.innovation));
  }
  EXPECT_EQ(recursive.refused(), bad.size());
  EXPECT_EQ(recursive.theta(), copy.theta());
  EXPECT_EQ(recursive.covariance(), copy.covariance());
  EXPECT_EQ(recursive.effective_samples(), copy.effective_samples());
}

TEST(RecursiveRegression, PinsWhatThePriorWeightPins) {
  auto simulated = simulate_regression(9, Eigen::Vector3d(0.5, 1.0, -1.0), neighbouring_errors(3, 0.02));
  const RegressionData& d = simulated.data;
  const Eigen::Vector3d prior(0.0, 0.0, -0.9), weight(1.0, 1.0, std::numeric_limits<double>::infinity());
  RecursiveOptions options{.error_covariance = d.error_covariance,
                           .prior = prior,
                           .prior_weight = weight,
                           .covariance = CovarianceKind::kWhite};
  options.forgetting.lambda = 1.0;
  RecursiveRegression recursive(d.parameter_names, options);
  feed(recursive, d);
  const RegressionEstimate batch =
      estimate(d, Method::kPcaGtls, {.covariance = CovarianceKind::kWhite, .prior = prior, .prior_weight = weight});
  EXPECT_EQ(recursive.theta()(2), -0.9);
  EXPECT_EQ(recursive.status(2), ParameterStatus::kFixed);
  EXPECT_LT(relative(recursive.theta(), batch.theta), kLastDigits);
  EXPECT_LT(relative(recursive.covariance(), batch.covariance), kLastDigits);
}

// What is found to be error of the equation counts for the rows before it too, and can be taken back.
TEST(RecursiveRegression, WithEquationErrorIsTheBatchEstimateOfThatCovariance) {
  const Eigen::MatrixXd W = neighbouring_errors(4, 0.02);
  RegressionData d = simulate_regression(7, Eigen::Vector4d(0.2, 1.0, -0.5, 0.3), W, {.rows = 700}).data;
  for (const Method method : {Method::kGtls, Method::kPcaGtls}) {
    RecursiveOptions options{.method = method, .error_covariance = W, .covariance = CovarianceKind::kWhite};
    options.forgetting.lambda = 1.0;
    RecursiveRegression recursive(d.parameter_names, options), plain(d.parameter_names, options);
    feed(plain, d);
    for (Eigen::Index k = 0; k < d.rows(); ++k) {
      if (k == 400) recursive.set_equation_error(0.3);
      recursive.update(std::span(d.regressors.row(k).data(), 4), d.regressand(k));
    }
    EXPECT_EQ(recursive.equation_error(), 0.3);
    d.error_covariance = W;
    d.error_covariance(4, 4) += 0.3;
    const RegressionEstimate batch = estimate(d, method, {.covariance = CovarianceKind::kWhite});
    EXPECT_LT(relative(recursive.theta(), batch.theta), kLastDigits) << to_string(method);
    EXPECT_LT(relative(recursive.covariance(), batch.covariance), kLastDigits) << to_string(method);
    EXPECT_GT(relative(plain.theta(), batch.theta), 1e-3) << "the difference must show";
    recursive.set_equation_error(0.0);
    EXPECT_LT(relative(recursive.theta(), plain.theta()), kLastDigits) << to_string(method);
  }
}

}  // namespace
}  // namespace veridyn::estimation
