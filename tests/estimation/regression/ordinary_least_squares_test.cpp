#include "veridyn/estimation/regression/ordinary_least_squares.hpp"

#include "tests/estimation/simulated_regression.hpp"
#include "veridyn/estimation/regression/regression.hpp"

namespace {
using namespace veridyn::estimation;
using testing_support::simulate_regression;

RegressionData longley() {
  // Longley (1967), as in NIST's Statistical Reference Datasets: condition number 5e9, "higher level of difficulty".
  Eigen::MatrixXd x(6, 16);
  x << 83.0, 88.5, 88.2, 89.5, 96.2, 98.1, 99.0, 100.0, 101.2, 104.6, 108.4, 110.8, 112.6, 114.2, 115.7, 116.9,  //
      234289, 259426, 258054, 284599, 328975, 346999, 365385, 363112, 397469, 419180, 442769, 444546, 482704, 502601,
      518173, 554894,                                                                                  //
      2356, 2325, 3682, 3351, 2099, 1932, 1870, 3578, 2904, 2822, 2936, 4681, 3813, 3931, 4806, 4007,  //
      1590, 1456, 1616, 1650, 3099, 3594, 3547, 3350, 3048, 2857, 2798, 2637, 2552, 2514, 2572, 2827,  //
      107608, 108632, 109773, 110929, 112075, 113270, 115094, 116219, 117388, 118734, 120445, 121950, 123366, 125368,
      127852, 130081,  //
      1947, 1948, 1949, 1950, 1951, 1952, 1953, 1954, 1955, 1956, 1957, 1958, 1959, 1960, 1961, 1962;
  RegressionData data;
  data.regressors.resize(16, 7);
  data.regressors << Eigen::VectorXd::Ones(16), x.transpose();
  data.regressand.resize(16);
  data.regressand << 60323, 61122, 60171, 61187, 63221, 63639, 64989, 63761, 66019, 67857, 68169, 66513, 68655, 69564,
      69331, 70551;
  data.parameter_names = {"B0", "B1", "B2", "B3", "B4", "B5", "B6"};
  return data;
}

TEST(OrdinaryLeastSquares, ReproducesTheCertifiedValuesOfLongley) {
  const double certified[7] = {-3482258.63459582, 15.0618722713733,      -0.358191792925910e-1, -2.02022980381683,
                               -1.03322686717359, -0.511041056535807e-1, 1829.15146461355};
  const double certified_sd[7] = {890420.383607373,  84.9149257747669,  0.334910077722432e-1, 0.488399681651699,
                                  0.214274163161675, 0.226073200069370, 455.478499142212};
  const RegressionEstimate e = estimate(longley(), Method::kOls, {.covariance = CovarianceKind::kWhite});
  ASSERT_TRUE(e.usable());
  for (int i = 0; i < 7; ++i) {
    // Condition number 5e9 (unscaled) times rounding leaves 7 digits to any backward-stable method; scaling gives more.
    EXPECT_NEAR(e.theta(i) / certified[i], 1.0, 1e-8) << i;
    EXPECT_NEAR(e.parameters[i].sigma / certified_sd[i], 1.0, 1e-8) << i;
  }
  EXPECT_NEAR(e.residual_sd, 304.854073561965, 1e-6);
  EXPECT_NEAR(e.r_squared, 0.995479004577296, 1e-12);
  EXPECT_GT(e.find("B6")->variance_inflation, 700.0);  // 758.98 in the literature on this set
  EXPECT_NEAR(e.find("B6")->variance_inflation, 758.98, 0.01);
}

TEST(OrdinaryLeastSquares, DoesNotChangeWithTheUnitsOfAColumn) {
  RegressionData data = longley();
  const RegressionEstimate before = estimate(data, Method::kOls, {.covariance = CovarianceKind::kWhite});
  data.regressors.col(2) *= 1e-6;
  data.regressand *= 1e3;
  const RegressionEstimate after = estimate(data, Method::kOls, {.covariance = CovarianceKind::kWhite});
  EXPECT_NEAR(after.theta(2) / before.theta(2), 1e9, 1.0);
  EXPECT_NEAR(after.parameters[2].t, before.parameters[2].t, 1e-7);
  EXPECT_NEAR(after.condition_number / before.condition_number, 1.0, 1e-8);
}

TEST(OrdinaryLeastSquares, SaysWhenRegressorsAreDependent) {
  RegressionData data = longley();
  data.regressors.col(1) = 3.0 * data.regressors.col(0) - 0.01 * data.regressors.col(3);
  const RegressionEstimate e = estimate(data, Method::kOls);
  EXPECT_EQ(e.termination, EstimateTermination::kRankDeficient);
  EXPECT_FALSE(e.usable());
  EXPECT_THAT(e.message, testing::HasSubstr("linearly dependent"));
  EXPECT_TRUE(std::isinf(e.parameters[1].sigma));
}

// The statement of the specification: nominal 95 % intervals hold under autocorrelated residuals where white ones do
// not.
TEST(OrdinaryLeastSquares, IntervalsCoverUnderColouredResiduals) {
  Eigen::VectorXd theta(4);
  theta << 0.1, -0.98, 0.3, 0.0;
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(5, 5);
  W(4, 4) = 0.2;
  double covered = 0.0, covered_white = 0.0, ratio = 0.0;
  const int runs = 400;
  for (int m = 0; m < runs; ++m) {
    const auto s = simulate_regression(static_cast<unsigned>(m + 1), theta, W,
                                       {.rows = 3000, .regressor_rho = 0.95, .error_rho = 0.9});
    const RegressionEstimate e = estimate(s.data, Method::kOls);
    for (Eigen::Index i = 0; i < 4; ++i) {
      const Parameter& p = e.parameters[i];
      covered += p.low95 < theta(i) && theta(i) < p.high95 ? 1.0 : 0.0;
      covered_white += std::abs(p.value - theta(i)) < 1.96 * p.sigma_white ? 1.0 : 0.0;
      ratio += p.sigma / p.sigma_white;
    }
  }
  EXPECT_GT(covered / (4.0 * runs), 0.93);
  EXPECT_LT(covered / (4.0 * runs), 0.97);
  EXPECT_LT(covered_white / (4.0 * runs), 0.65);
  EXPECT_GT(ratio / (4.0 * runs), 2.5);
}

}  // namespace
