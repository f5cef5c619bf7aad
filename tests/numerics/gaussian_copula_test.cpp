#include "veridyn/numerics/gaussian_copula.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::numerics {
namespace {

Eigen::MatrixXd normal_draws(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
  RandomStream random(seed, "copula test");
  Eigen::MatrixXd m(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j) {
    for (Eigen::Index i = 0; i < rows; ++i) m(i, j) = random.normal();
  }
  return m;
}

double correlation(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const Eigen::VectorXd x = a.array() - a.mean(), y = b.array() - b.mean();
  return x.dot(y) / (x.norm() * y.norm());
}

TEST(GaussianCopula, GivesUniformVariablesOfTheCorrelationAskedFor) {
  Eigen::MatrixXd rho(3, 3);
  rho << 1.0, 0.8, -0.3, 0.8, 1.0, 0.1, -0.3, 0.1, 1.0;
  const GaussianCopula copula(rho);
  constexpr Eigen::Index kDraws = 100000;
  Eigen::MatrixXd u = normal_draws(3, kDraws, 1);
  copula.couple(u);
  for (Eigen::Index i = 0; i < 3; ++i) {
    // Kolmogorov-Smirnov at p = 0.001: 1.95/sqrt(N).
    std::vector<double> x(u.row(i).begin(), u.row(i).end());
    std::sort(x.begin(), x.end());
    double distance = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      distance = std::max(distance, std::abs(x[k] - (static_cast<double>(k) + 0.5) / static_cast<double>(x.size())));
    }
    EXPECT_LT(distance, 1.95 / std::sqrt(static_cast<double>(kDraws)));
    // Standard error of a correlation is at most 1/sqrt(N) = 0.0032; four of them.
    for (Eigen::Index j = 0; j < i; ++j) EXPECT_NEAR(correlation(u.row(i), u.row(j)), rho(i, j), 0.0127);
  }
  EXPECT_EQ(copula.repair().largest_change, 0.0);
}

// Corner cases have to be exact: independent stays independent, equal stays equal.
TEST(GaussianCopula, MapsTheEndsOfTheScaleOntoThemselves) {
  EXPECT_EQ(normal_correlation_for_uniform(0.0), 0.0);
  EXPECT_NEAR(normal_correlation_for_uniform(1.0), 1.0, 1e-15);
  EXPECT_NEAR(normal_correlation_for_uniform(-1.0), -1.0, 1e-15);
  EXPECT_NEAR(normal_correlation_for_uniform(0.5), 0.5176380902, 1e-10);
  Eigen::MatrixXd u = normal_draws(2, 1000, 2);
  GaussianCopula(Eigen::MatrixXd::Ones(2, 2)).couple(u);
  // The floor on the eigenvalues leaves about 1e-5 of independent motion.
  EXPECT_LT((u.row(0) - u.row(1)).cwiseAbs().maxCoeff(), 1e-4);
}

// Higham (2002), section 4: the tridiagonal matrix and its nearest correlation matrix to the printed digits (also the
// example of NAG's g02aaf).
TEST(NearestCorrelation, IsHighamsForHisExample) {
  Eigen::MatrixXd a(4, 4), expected(4, 4);
  a << 2, -1, 0, 0, -1, 2, -1, 0, 0, -1, 2, -1, 0, 0, -1, 2;
  expected << 1.0, -0.8084, 0.1916, 0.1068, -0.8084, 1.0, -0.6562, 0.1916, 0.1916, -0.6562, 1.0, -0.8084, 0.1068,
      0.1916, -0.8084, 1.0;
  const NearestCorrelation nearest = nearest_correlation(a, 0.0);
  EXPECT_TRUE(nearest.converged);
  EXPECT_LT((nearest.matrix - expected).cwiseAbs().maxCoeff(), 5.1e-5);
  EXPECT_NEAR(nearest.largest_change, 1.0 - 0.6562, 5.1e-5);
}

TEST(NearestCorrelation, LeavesACorrelationMatrixAloneAndRepairsTheOthersToTheFloor) {
  RandomStream random(3, "nearest");
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Index n = 2 + trial % 8;
    Eigen::MatrixXd a = Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < i; ++j) a(i, j) = a(j, i) = random.uniform(-1.0, 1.0);
    }
    const double before = symmetric_eigenvalues(a)(0);
    const NearestCorrelation nearest = nearest_correlation(a, 1e-6);
    const double after = symmetric_eigenvalues(nearest.matrix)(0);
    EXPECT_GE(after, 1e-6 - 1e-12);
    EXPECT_LT((nearest.matrix.diagonal().array() - 1.0).abs().maxCoeff(), 1e-15);
    EXPECT_EQ(nearest.largest_change == 0.0, before >= 1e-6) << before;
  }
}

TEST(RankCorrelation, IgnoresMonotoneMapsAndColumnsThatDoNotVary) {
  Eigen::MatrixXd x = normal_draws(500, 3, 4);
  x.col(1) = x.col(0).array().exp();
  x.col(2).setConstant(7.0);
  const Eigen::MatrixXd rho = rank_correlation(x);
  EXPECT_NEAR(rho(0, 1), 1.0, 1e-12);
  EXPECT_EQ(rho(0, 2), 0.0);
  EXPECT_EQ(rho(2, 2), 1.0);
  // Ties at their mean rank: ranks 0, 1.5, 1.5, 3 against 0, 1, 2, 3 have correlation 4.5/sqrt(4.5 * 5).
  Eigen::MatrixXd ties(4, 2);
  ties << 1, 1, 2, 2, 2, 3, 5, 4;
  EXPECT_NEAR(rank_correlation(ties)(0, 1), 4.5 / std::sqrt(4.5 * 5.0), 1e-14);
}

}  // namespace
}  // namespace veridyn::numerics
