#include "veridyn/estimation/regression/regression.hpp"

#include "tests/estimation/regression/four_parameters.hpp"
#include "tests/estimation/simulated_regression.hpp"

namespace {
using namespace veridyn::estimation;
using testing_support::correlated_noise;
using testing_support::errors;
using testing_support::regression_theta;
using testing_support::simulate_regression;

TEST(Widen, StretchesIntervalsAndJudgesSignificanceAnew) {
  const auto s = simulate_regression(6, regression_theta(), errors(0.1, 0.1));
  const RegressionEstimate before = estimate(s.data, Method::kGtls);
  RegressionEstimate e = before;
  widen(e, 0.5, 0.05);
  EXPECT_EQ(e.parameters[1].sigma, before.parameters[1].sigma);
  widen(e, 4.0, 0.05);
  EXPECT_DOUBLE_EQ(e.covariance(1, 2), 4.0 * before.covariance(1, 2));
  EXPECT_DOUBLE_EQ(e.parameters[1].sigma, 2.0 * before.parameters[1].sigma);
  EXPECT_NEAR(e.parameters[1].high95 - e.parameters[1].value,
              2.0 * (before.parameters[1].high95 - before.parameters[1].value), 1e-12);
  EXPECT_EQ(e.parameters[1].value, before.parameters[1].value);
  ASSERT_EQ(e.parameters[1].status, ParameterStatus::kIdentified);
  widen(e, 1e8, 0.05);
  EXPECT_EQ(e.parameters[1].status, ParameterStatus::kInsignificant);
}

// Lateral regressors as flown: sideslip, two rates, two deflections, with a constant; theta as in the source's tables.
struct Lateral {
  RegressionData data;
  RowMatrix X;
  Eigen::VectorXd z;
};

Lateral lateral(unsigned seed, const Eigen::VectorXd& theta, double snr, double regressor_ratio, Eigen::Index rows) {
  std::mt19937_64 generator(seed);
  const double size[5] = {0.05, 0.03, 0.02, 0.08, 0.08};
  Lateral s;
  s.X.resize(rows, 6);
  s.X.col(0).setOnes();
  for (Eigen::Index j = 0; j < 5; ++j) s.X.col(j + 1) = size[j] * correlated_noise(generator, rows, 0.95);
  s.z = s.X * theta;
  const double power = (s.z.array() - s.z.mean()).square().mean();
  s.data.error_covariance = Eigen::MatrixXd::Zero(7, 7);
  s.data.error_covariance(6, 6) = power / snr;
  s.data.regressors = s.X;
  s.data.regressand = s.z + std::sqrt(power / snr) * correlated_noise(generator, rows, 0.0);
  for (Eigen::Index j = 1; j < 6 && regressor_ratio > 0.0; ++j) {
    const double variance = regressor_ratio * size[j - 1] * size[j - 1];
    s.data.regressors.col(j) += std::sqrt(variance) * correlated_noise(generator, rows, 0.0);
    s.data.error_covariance(j, j) = variance;
  }
  s.data.parameter_names = {"0", "beta", "p", "r", "da", "dr"};
  return s;
}

// SNR: power of the true regressand about its mean over the power of its noise.
TEST(PublishedTables, OlsWithExactRegressorsIsUnbiasedAndCovers) {
  struct Case {
    double snr;
    Eigen::VectorXd theta;
  };
  Case cases[2] = {{30.0, Eigen::VectorXd(6)}, {45.0, Eigen::VectorXd(6)}};
  cases[0].theta << 0.0, -0.98, 0.0, 0.0, 0.0, -0.20;        // CY
  cases[1].theta << 0.0, -0.12, -1.00, 0.14, 0.25, -0.0037;  // Cl
  for (const Case& c : cases) {
    const int runs = 1000;
    Eigen::VectorXd mean_error = Eigen::VectorXd::Zero(6), sigma = Eigen::VectorXd::Zero(6);
    double covered = 0.0;
    for (int m = 0; m < runs; ++m) {
      const Lateral s = lateral(static_cast<unsigned>(m + 1), c.theta, c.snr, 0.0, 400);
      const RegressionEstimate e = estimate(s.data, Method::kOls, {.covariance = CovarianceKind::kWhite});
      for (Eigen::Index i = 0; i < 6; ++i) {
        const Parameter& p = e.parameters[i];
        mean_error(i) += (p.value - c.theta(i)) / runs;
        sigma(i) += p.sigma / runs;
        covered += p.low95 < c.theta(i) && c.theta(i) < p.high95 ? 1.0 : 0.0;
      }
    }
    for (Eigen::Index i = 0; i < 6; ++i) {
      EXPECT_LT(std::abs(mean_error(i)), 0.1 * sigma(i)) << "parameter " << i << ", SNR " << c.snr;
      if (std::abs(c.theta(i)) > 10.0 * sigma(i)) {
        EXPECT_LT(std::abs(mean_error(i)), 0.01 * std::abs(c.theta(i)));
      }
    }
    EXPECT_NEAR(covered / (6.0 * runs), 0.95, 0.02);
  }
}

TEST(PublishedTables, NoiseOnRegressorsBiasesOlsAndNotGtls) {
  Eigen::VectorXd theta(6);
  theta << 0.0, 0.25, 0.022, -1.00, 0.0, 0.10;  // Cn
  const int runs = 40;
  double covered = 0.0, worst_gtls = 0.0, worst_ols = 0.0;
  Eigen::VectorXd mean_ols = Eigen::VectorXd::Zero(6), mean_gtls = Eigen::VectorXd::Zero(6);
  for (int m = 0; m < runs; ++m) {
    const Lateral s = lateral(static_cast<unsigned>(m + 1), theta, 45.0, 0.3, 8000);
    const RegressionEstimate gtls = estimate(s.data, Method::kGtls), ols = estimate(s.data, Method::kOls);
    const auto output_error = [&](const RegressionEstimate& e) {
      return (s.z - s.X * e.theta).cwiseAbs().maxCoeff() / s.z.cwiseAbs().maxCoeff();
    };
    worst_gtls += output_error(gtls) / runs;
    worst_ols += output_error(ols) / runs;
    mean_ols += ols.theta / runs;
    mean_gtls += gtls.theta / runs;
    for (Eigen::Index i = 0; i < 6; ++i) {
      const Parameter& p = gtls.parameters[i];
      covered += p.low95 < theta(i) && theta(i) < p.high95 ? 1.0 : 0.0;
    }
  }
  EXPECT_LT(worst_gtls, 0.04);
  EXPECT_GT(worst_ols, 0.10);
  // Uncorrelated regressors with 0.3 of their variance in noise: OLS is attenuated to 1/1.3.
  EXPECT_NEAR(mean_ols(3), -1.0 / 1.3, 0.02);
  EXPECT_NEAR(mean_gtls(3), -1.0, 0.01);
  EXPECT_NEAR(covered / (6.0 * runs), 0.95, 0.03);
}

}  // namespace
