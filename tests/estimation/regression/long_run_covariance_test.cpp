#include "veridyn/estimation/regression/long_run_covariance.hpp"

#include "tests/estimation/simulated_regression.hpp"

namespace {
using namespace veridyn::estimation;

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

// The sum of N samples of a first-order process has the variance N (1 + rho)/(1 - rho); the estimate scatters as its
// degrees of freedom say.
TEST(LongRunCovariance, OfAFirstOrderProcessIsItsClosedForm) {
  const Eigen::Index N = 50000, window = 25;
  const SegmentRanges segments = {{0, 20000}, {20000, N}};
  std::mt19937_64 generator(9);
  for (const double rho : {0.8, 0.0, -0.5}) {
    const RowMatrix x = testing_support::correlated_noise(generator, N, rho);
    const double expected = (1.0 + rho) / (1.0 - rho);
    const LongRunCovariance direct = long_run_covariance(x, segments, window);
    const double scatter = std::sqrt(2.0 / direct.degrees_of_freedom);
    EXPECT_LT(scatter, 0.1);
    EXPECT_NEAR(direct.matrix(0, 0) / static_cast<double>(N), expected, 3.0 * scatter * expected) << rho;
    const LongRunCovariance by_residual =
        autocorrelated_normal_matrix(RowMatrix::Ones(N, 1), x.col(0), segments, window);
    EXPECT_NEAR(by_residual.matrix(0, 0) / static_cast<double>(N), expected, 3.0 * scatter * expected) << rho;
  }
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

}  // namespace
