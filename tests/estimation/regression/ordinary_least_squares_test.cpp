#include "veridyn/estimation/regression/ordinary_least_squares.hpp"

#include "tests/estimation/simulated_regression.hpp"
#include "veridyn/estimation/regression/augmented_qr.hpp"
#include "veridyn/estimation/regression/long_run_covariance.hpp"
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
    EXPECT_NEAR(e.parameters[static_cast<std::size_t>(i)].sigma / certified_sd[i], 1.0, 1e-8) << i;
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

// Double sum of Morelli & Klein, term by term.
TEST(AutocorrelatedNormalMatrix, EqualsTheDoubleSumOverRowsOfEverySegment) {
  const Eigen::Index N = 60, window = 4;
  const RowMatrix X = RowMatrix::Random(N, 3);
  Eigen::VectorXd r = Eigen::VectorXd::Random(N);
  for (Eigen::Index k = 1; k < N; ++k) r(k) += 0.9 * r(k - 1);
  const SegmentRanges segments = {{0, 25}, {25, 60}};
  const auto same = [](Eigen::Index i, Eigen::Index j) { return (i < 25) == (j < 25); };
  double weight_sum = 0.0;
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(3, 3);
  for (Eigen::Index lag = -2 * window + 1; lag < 2 * window; ++lag) {
    const double w = std::min(1.0, 2.0 - std::abs(static_cast<double>(lag)) / static_cast<double>(window));
    weight_sum += w;
    double covariance = 0.0;
    for (Eigen::Index k = 0; k < N; ++k) {
      if (k + lag >= 0 && k + lag < N && same(k, k + lag)) covariance += r(k) * r(k + lag) / static_cast<double>(N);
    }
    for (Eigen::Index k = 0; k < N; ++k) {
      if (k + lag >= 0 && k + lag < N && same(k, k + lag))
        expected += w * covariance * X.row(k).transpose() * X.row(k + lag);
    }
  }
  expected /= 1.0 - weight_sum / static_cast<double>(N);
  const LongRunCovariance result = autocorrelated_normal_matrix(X, r, segments, window);
  EXPECT_LT((result.matrix - expected).norm(), 1e-12 * expected.norm());
}

TEST(LongRunCovariance, EqualsTheSumOverLagsWithAFlatTop) {
  const Eigen::Index N = 400, window = 6;
  RowMatrix g = RowMatrix::Random(N, 2);
  for (Eigen::Index k = 1; k < N; ++k) g.row(k) += 0.8 * g.row(k - 1);
  const SegmentRanges segments = {{0, 150}, {150, 400}};
  double weight_sum = 0.0;
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(2, 2);
  for (Eigen::Index lag = -2 * window + 1; lag < 2 * window; ++lag) {
    const double w = std::min(1.0, 2.0 - std::abs(static_cast<double>(lag)) / static_cast<double>(window));
    weight_sum += w;
    for (Eigen::Index k = 0; k < N; ++k) {
      if (k + lag < 0 || k + lag >= N || ((k < 150) != (k + lag < 150))) continue;
      expected += w * g.row(k).transpose() * g.row(k + lag);
    }
  }
  expected /= 1.0 - weight_sum / static_cast<double>(N);
  EXPECT_LT((long_run_covariance(g, segments, window).matrix - expected).norm(), 1e-12 * expected.norm());
}

// Independent rows of unit variances: Cov(x r) is the identity, and that of r^2/s2 - 1 is 2.
TEST(ScoreCovariance, AddsWhatTheSquareOfTheResidualVaries) {
  std::mt19937_64 generator(4);
  const Eigen::Index N = 20000;
  Scores scores;
  scores.regressors.resize(N, 2);
  for (Eigen::Index j = 0; j < 2; ++j) scores.regressors.col(j) = testing_support::correlated_noise(generator, N, 0.0);
  scores.residual = 3.0 * testing_support::correlated_noise(generator, N, 0.0);
  scores.quadratic = Eigen::Vector2d(0.0, 5.0);
  EXPECT_NEAR(scores.rows().col(1).sum(), scores.residual.dot(scores.regressors.col(1)), 1e-6);
  const Eigen::MatrixXd S = score_covariance(scores, {{0, N}}, 0).matrix / static_cast<double>(N);
  EXPECT_NEAR(S(0, 0), 9.0, 0.3);
  EXPECT_NEAR(S(1, 1), 9.0 + 50.0, 2.0);
  EXPECT_NEAR(S(0, 1), 0.0, 0.6);
}

TEST(CorrelationLength, IsZeroForWhiteNoiseAndThatOfAMovingAverageOtherwise) {
  std::mt19937_64 generator(4);
  const Eigen::VectorXd white = testing_support::correlated_noise(generator, 20000, 0.0);
  const SegmentRanges whole = {{0, 20000}};
  EXPECT_LE(correlation_length(white, whole, 500), 2);
  Eigen::VectorXd average = Eigen::VectorXd::Zero(20000);  // of 8 samples: correlated to lag 7
  for (Eigen::Index k = 8; k < 20000; ++k) average(k) = white.segment(k - 8, 8).sum();
  EXPECT_NEAR(static_cast<double>(correlation_length(average, whole, 500)), 7.0, 1.0);
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
      const Parameter& p = e.parameters[static_cast<std::size_t>(i)];
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
