#include "veridyn/estimation/regression/total_least_squares.hpp"

#include "tests/estimation/regression/correlated_errors.hpp"
#include "tests/estimation/simulated_regression.hpp"
#include "veridyn/estimation/regression/augmented_qr.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"
#include "veridyn/numerics/linear_algebra/singular_values.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"

namespace {
using namespace veridyn::estimation;
using testing_support::correlated_errors;
using testing_support::simulate_regression;
using testing_support::true_parameters;
namespace numerics = veridyn::numerics;

Eigen::MatrixXd augmented(const RegressionData& data) {
  Eigen::MatrixXd D(data.rows(), data.parameters() + 1);
  D << data.regressors, data.regressand;
  return D;
}

// Deming (1943): the slope of a line through points with errors of equal variance in both coordinates.
TEST(TotalLeastSquares, GivesTheOrthogonalLineOfDemingsClosedForm) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  RegressionData data;
  data.regressors.resize(200, 2);
  data.regressand.resize(200);
  for (Eigen::Index k = 0; k < 200; ++k) {
    const double x = normal(generator);
    data.regressors.row(k) << 1.0, x + 0.4 * normal(generator);
    data.regressand(k) = 2.0 - 1.5 * x + 0.4 * normal(generator);
  }
  data.parameter_names = {"offset", "slope"};
  const double mx = data.regressors.col(1).mean(), mz = data.regressand.mean();
  const Eigen::ArrayXd x = data.regressors.col(1).array() - mx, z = data.regressand.array() - mz;
  const double sxx = (x * x).sum(), szz = (z * z).sum(), sxz = (x * z).sum();
  const double slope = (szz - sxx + std::sqrt((szz - sxx) * (szz - sxx) + 4.0 * sxz * sxz)) / (2.0 * sxz);
  const RegressionEstimate e = estimate(data, Method::kTls);
  ASSERT_TRUE(e.usable());
  EXPECT_NEAR(e.theta(1), slope, 1e-12);
  EXPECT_NEAR(e.theta(0), mz - slope * mx, 1e-12);
}

// Van Huffel & Vandewalle (1991), theorem 2.7: (X'X - s_min^2 I) theta = X'z, without any SVD of ours.
TEST(TotalLeastSquares, SolvesTheCorrectedNormalEquations) {
  RowMatrix X = RowMatrix::Random(300, 4);
  const Eigen::VectorXd z = X * true_parameters() + 0.1 * Eigen::VectorXd::Random(300);
  RegressionData data;
  data.regressors = X;
  data.regressand = z;
  data.parameter_names = {"a", "b", "c", "d"};
  const RegressionEstimate e = estimate(data, Method::kTls);
  const Eigen::MatrixXd D = augmented(data);
  const double smallest = numerics::symmetric_eigenvalues(numerics::transposed_product(D, D))(0);
  const Eigen::MatrixXd normal = numerics::transposed_product(X, X) - smallest * Eigen::MatrixXd::Identity(4, 4);
  const Eigen::VectorXd right = numerics::transposed_product(X, z);
  EXPECT_LT((e.theta - numerics::solve_symmetric(normal, right)).norm(), 1e-12);
}

TEST(GeneralisedTotalLeastSquares, EqualsTheDirectSvdOfTheWhitenedMatrix) {
  // No exact column, so D C^-1 exists: with the constant replaced by another noisy regressor.
  auto s = simulate_regression(5, true_parameters(), correlated_errors(0.5));
  Eigen::MatrixXd W = s.data.error_covariance;
  W(0, 0) = 0.3;
  s.data.error_covariance = W;
  const Eigen::MatrixXd C_inverse = numerics::Cholesky(W).solve_upper(Eigen::MatrixXd::Identity(5, 5));
  const Eigen::MatrixXd white = numerics::product(augmented(s.data), C_inverse);
  const numerics::SingularValues svd = numerics::singular_values(white, numerics::SingularVectors::kThinUAndFullV);
  const Eigen::VectorXd h = numerics::product(C_inverse, svd.V.col(4));
  const RegressionEstimate e = estimate(s.data, Method::kGtls);
  EXPECT_LT((e.theta - h.head(4) / -h(4)).norm(), 1e-12);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(e.singular_values[i], svd.values(i), 1e-10);
}

// An exact constant takes the means away: mixed OLS-TLS on the columns without their means.
TEST(GeneralisedTotalLeastSquares, TreatsAnExactConstantLikeRemovedMeans) {
  const auto s = simulate_regression(6, true_parameters(), correlated_errors(0.5));
  RegressionData centred = s.data;
  centred.regressors = s.data.regressors.rightCols(3).rowwise() - s.data.regressors.rightCols(3).colwise().mean();
  centred.regressand.array() -= s.data.regressand.mean();
  centred.parameter_names = {"a", "b", "c"};
  centred.error_covariance = s.data.error_covariance.bottomRightCorner(4, 4);
  const RegressionEstimate with = estimate(s.data, Method::kGtls);
  const RegressionEstimate without = estimate(centred, Method::kGtls);
  EXPECT_LT((with.theta.tail(3) - without.theta).norm(), 1e-12);
  EXPECT_LT((with.covariance_white.bottomRightCorner(3, 3) / without.covariance_white(0, 0) -
             without.covariance_white / without.covariance_white(0, 0))
                .norm(),
            5e-3);  // N - n_p differs by one
}

TEST(GeneralisedTotalLeastSquares, WithExactRegressorsIsOrdinaryLeastSquares) {
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(5, 5);
  W(4, 4) = 0.1;
  const auto s = simulate_regression(7, true_parameters(), W);
  const RegressionOptions white{.covariance = CovarianceKind::kWhite};
  const RegressionEstimate gtls = estimate(s.data, Method::kGtls, white), ols = estimate(s.data, Method::kOls, white);
  EXPECT_LT((gtls.theta - ols.theta).norm(), 1e-13);
  EXPECT_LT((gtls.covariance - ols.covariance).norm(), 1e-12 * ols.covariance.norm());
}

TEST(GeneralisedTotalLeastSquares, DoesNotChangeWithTheUnitsOfColumns) {
  const auto s = simulate_regression(8, true_parameters(), correlated_errors(1.0));
  RegressionData scaled = s.data;
  Eigen::VectorXd unit(5);
  unit << 1.0, 1e-4, 2e3, 57.3, 1e5;
  scaled.regressors = s.data.regressors * unit.head(4).asDiagonal();
  scaled.regressand *= unit(4);
  scaled.error_covariance = unit.asDiagonal() * s.data.error_covariance * unit.asDiagonal();
  const RegressionEstimate before = estimate(s.data, Method::kGtls), after = estimate(scaled, Method::kGtls);
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_NEAR(after.theta(i) * unit(i) / unit(4), before.theta(i), 1e-11);
    EXPECT_NEAR(after.parameters[i].t / before.parameters[i].t, 1.0, 1e-9);
  }
  EXPECT_NEAR(after.singular_values[0] / before.singular_values[0], 1.0, 1e-12);
}

// Two regressors with one and the same error: W is singular, their difference is exact. The limit of small independent
// errors is the independent formulation.
TEST(GeneralisedTotalLeastSquares, AcceptsFullyCorrelatedErrors) {
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(5, 5);
  W.block(1, 1, 2, 2).setConstant(0.3);
  W(3, 3) = 0.1;
  W(4, 4) = 0.05;
  auto s = simulate_regression(9, true_parameters(), W, {.rows = 20000});
  const RegressionEstimate singular = estimate(s.data, Method::kGtls);
  ASSERT_TRUE(singular.usable());
  EXPECT_EQ(singular.singular_values.size(), 3U);
  s.data.error_covariance(1, 1) += 1e-7;
  s.data.error_covariance(2, 2) += 1e-7;
  const RegressionEstimate nearly = estimate(s.data, Method::kGtls);
  EXPECT_EQ(nearly.singular_values.size(), 4U);
  EXPECT_LT((singular.theta - nearly.theta).norm(), 1e-5);
  for (Eigen::Index i = 0; i < 4; ++i)
    EXPECT_NEAR(singular.theta(i), true_parameters()(i), 4.0 * singular.parameters[i].sigma);
}

TEST(TotalLeastSquares, ReportsTheNongenericCase) {
  // The second regressor is smaller than the residual and z is orthogonal to it: the smallest singular vector has no z.
  RegressionData data;
  data.regressors = RowMatrix::Zero(6, 2);
  data.regressand = Eigen::VectorXd::Zero(6);
  data.parameter_names = {"a", "b"};
  data.regressors(0, 0) = 3.0;
  data.regressors(1, 1) = 0.1;
  data.regressand(0) = 2.0;
  data.regressand(2) = 1.0;
  const RegressionEstimate e = estimate(data, Method::kTls);
  EXPECT_EQ(e.termination, EstimateTermination::kNongeneric);
  EXPECT_THAT(e.message, testing::HasSubstr("no TLS solution"));
  EXPECT_TRUE(std::isinf(e.parameters[0].sigma));
}

TEST(TotalLeastSquares, JacobianIsTheDerivativeOfTheSumOfScores) {
  const auto s = simulate_regression(10, true_parameters(), correlated_errors(0.5));
  const Eigen::MatrixXd W = s.data.error_covariance;
  const TotalLeastSquares tls = total_least_squares(triangle_of(s.data), W, static_cast<double>(s.data.rows()));
  const auto sum_at = [&](const Eigen::VectorXd& theta) {
    const Scores scores =
        errors_in_variables_scores(s.data.regressors, s.data.regressand, W, theta, ErrorRatio::kKnown);
    return Eigen::VectorXd(scores.rows().colwise().sum());
  };
  EXPECT_LT(sum_at(tls.theta).norm(), 1e-9);
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double step = 1e-5;
    const Eigen::VectorXd e = step * Eigen::VectorXd::Unit(4, i);
    const Eigen::VectorXd derivative = (sum_at(tls.theta + e) - sum_at(tls.theta - e)) / (2.0 * step);
    EXPECT_LT((derivative + tls.jacobian.col(i)).norm(), 1e-6 * tls.jacobian.norm()) << i;
  }
}

struct CoverageCase {
  const char* name;
  testing_support::SimulationSettings settings;
  bool equation_error;
  std::vector<double> ratios;
};

class TlsCoverage : public testing::TestWithParam<CoverageCase> {};

// At ratios of error to signal variance, pooled over parameters: the standard error of a share over
// 250 runs of 4 parameters is 0.007 (runs independent, parameters nearly so).
TEST_P(TlsCoverage, IntervalsHoldWhatTheyPromise) {
  const CoverageCase& c = GetParam();
  const Eigen::VectorXd theta = true_parameters();
  const int runs = 250;
  for (const double ratio : c.ratios) {
    double covered = 0.0, deviation = 0.0;
    for (int m = 0; m < runs; ++m) {
      auto s = simulate_regression(static_cast<unsigned>(m + 1), theta, correlated_errors(ratio), c.settings);
      if (c.equation_error) {
        s.data.error_covariance(4, 4) *= 0.5;
        s.data.regressand_error_known = false;
      }
      const RegressionEstimate e = estimate(s.data, Method::kGtls);
      ASSERT_TRUE(e.usable());
      for (Eigen::Index i = 0; i < 4; ++i) {
        const Parameter& p = e.parameters[i];
        covered += p.low95 < theta(i) && theta(i) < p.high95 ? 1.0 : 0.0;
        deviation += std::pow((p.value - theta(i)) / p.sigma, 2);
      }
    }
    EXPECT_GE(covered / (4.0 * runs), 0.93) << c.name << ", ratio " << ratio;
    EXPECT_LE(covered / (4.0 * runs), 0.97) << c.name << ", ratio " << ratio;
    EXPECT_NEAR(deviation / (4.0 * runs), 1.0, 0.2) << c.name << ", ratio " << ratio;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Colours, TlsCoverage,
    testing::Values(
        CoverageCase{"white", {.rows = 1500, .regressor_rho = 0.0}, false, {0.05, 0.5, 1.0, 3.0}},
        CoverageCase{"AR(1) errors", {.rows = 5000, .regressor_rho = 0.9, .error_rho = 0.8}, false, {0.05, 1.0}},
        CoverageCase{
            "low-passed errors", {.rows = 6000, .regressor_rho = 0.97, .error_pass_Hz = 10.0}, false, {0.5, 3.0}},
        CoverageCase{"equation error", {.rows = 6000, .regressor_rho = 0.97, .error_pass_Hz = 10.0}, true, {1.0}}),
    [](const auto& test) {
      std::string name = test.param.name;
      for (char& ch : name) ch = std::isalnum(static_cast<unsigned char>(ch)) != 0 ? ch : '_';
      return name;
    });

/// Share of 95 % intervals of GTLS that hold the truth.
template <typename Spoil>
double coverage_of_gtls(const testing_support::SimulationSettings& settings, double regressor_error, int runs,
                        const Spoil& spoil) {
  const Eigen::VectorXd theta = true_parameters();
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(5, 5);
  W.diagonal().tail(4).setConstant(regressor_error * regressor_error);
  double covered = 0.0;
  for (int m = 0; m < runs; ++m) {
    auto s = simulate_regression(static_cast<unsigned>(m + 1), theta, W, settings);
    spoil(s);
    const RegressionEstimate e = estimate(s.data, Method::kGtls);
    for (Eigen::Index i = 0; i < 4; ++i) {
      const Parameter& p = e.parameters[i];
      covered += p.low95 < theta(i) && theta(i) < p.high95 ? 1.0 : 0.0;
    }
  }
  return covered / (4.0 * runs);
}

// Four seconds at 100 Hz, errors low-passed at 3 Hz: by the scores' own covariance intervals held the truth in 89 %.
TEST(TotalLeastSquares, IntervalsOfShortCorrelatedRecordsHoldTheTruth) {
  for (const double error : {0.05, 0.2}) {
    const double covered =
        coverage_of_gtls({.rows = 401, .regressor_rho = 0.98, .error_pass_Hz = 3.0}, error, 250, [](const auto&) {});
    EXPECT_GE(covered, 0.93) << error;
    EXPECT_LE(covered, 0.975) << error;
  }
}

// Where the regressors move twice as far the error of z is ten times as large, as of a model that lacks something:
// the residual's autocorrelation alone does not see that these rows count most.
TEST(TotalLeastSquares, IntervalsAllowForResidualsThatGrowInManoeuvres) {
  const auto grow = [](auto& s) {
    s.data.regressand_error_known = false;
    for (Eigen::Index k = 0; k < s.data.rows(); ++k) {
      const double x = s.true_regressors.row(k).tail(3).norm();
      s.data.regressand(k) += (s.data.regressand(k) - s.true_regressand(k)) * std::min(9.0, x * x);
    }
  };
  EXPECT_GE(coverage_of_gtls({.rows = 4000, .regressor_rho = 0.9, .error_pass_Hz = 10.0}, 0.05, 150, grow), 0.93);
}

// With W = diag(0, w, 1) and theta = -1 the variance is [s2 + w c^2]/(N c), s2 = 1 + w; without its second term
// intervals would hold the truth with probability 2 Phi(1.96 sqrt(s2/(s2 + w))) - 1: 0.91, 0.89, 0.86 at w = 0.5, 1, 3.
TEST(TotalLeastSquares, WithoutTheSecondOrderTermIntervalsWouldBeTooNarrow) {
  Eigen::VectorXd theta(2);
  theta << 0.2, -1.0;
  for (const double ratio : {0.5, 1.0, 3.0}) {
    Eigen::MatrixXd W = Eigen::MatrixXd::Zero(3, 3);
    W(1, 1) = ratio;
    W(2, 2) = 1.0;
    double with = 0.0, without = 0.0;
    const int runs = 1000;
    for (int m = 0; m < runs; ++m) {
      const auto s = simulate_regression(static_cast<unsigned>(m + 1), theta, W, {.rows = 1000, .regressor_rho = 0.0});
      const TotalLeastSquares tls = total_least_squares(triangle_of(s.data), W, 1000.0);
      Eigen::VectorXd h(3);
      h << tls.theta, -1.0;
      const double s2 = tls.error_scale * h.dot(W * h);
      const double error = std::abs(tls.theta(1) - theta(1));
      with += error < 1.96 * std::sqrt(tls.covariance_white(1, 1)) ? 1.0 : 0.0;
      without += error < 1.96 * std::sqrt(s2 * tls.inverse_jacobian(1, 1)) ? 1.0 : 0.0;
    }
    const double expected = 2.0 * numerics::normal_cdf(1.96 * std::sqrt((1.0 + ratio) / (1.0 + 2.0 * ratio))) - 1.0;
    // Three standard errors of a share over 1000 runs.
    EXPECT_NEAR(with / runs, 0.95, 0.021) << ratio;
    EXPECT_NEAR(without / runs, expected, 0.03) << ratio;
  }
}

}  // namespace
