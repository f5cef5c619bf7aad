#include "veridyn/numerics/linear_algebra/orthogonal.hpp"

#include <gtest/gtest.h>

namespace veridyn::numerics {
namespace {

TEST(HouseholderQr, SplitsAMatrixIntoAnOrthogonalAndATriangularFactor) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Random(6, 3);
  const HouseholderQr qr(A);
  const Eigen::MatrixXd Q = qr.Q();
  EXPECT_TRUE((Q.transpose() * Q).isIdentity(1e-13));
  EXPECT_TRUE(qr.thin_Q().isApprox(Q.leftCols(3), 1e-14));
  EXPECT_TRUE(qr.R().isUpperTriangular());
  EXPECT_TRUE((Q.leftCols(3) * qr.R()).isApprox(A, 1e-13));
  const Eigen::VectorXd b = Eigen::VectorXd::Random(6);
  EXPECT_TRUE(qr.apply_transposed(b).isApprox(Q.transpose() * b, 1e-13));
  EXPECT_TRUE(qr.apply_transposed(A).isApprox(Q.transpose() * A, 1e-13));
}

// An hour of flight has so many rows: the square factor would take 80 GB.
TEST(HouseholderQr, SpansTheColumnsOfATallMatrixInItsOwnMemory) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Random(100'000, 4);
  const Eigen::MatrixXd Q = HouseholderQr(A).thin_Q();
  EXPECT_TRUE((Q.transpose() * Q).isIdentity(1e-12));
  EXPECT_TRUE((Q * (Q.transpose() * A)).isApprox(A, 1e-12));
}

// The straight line through (0, 1), (1, 2), (2, 4) that is closest in the mean square: 5/6 + 3/2 x.
TEST(HouseholderQr, FitsALine) {
  Eigen::MatrixXd A(3, 2);
  A << 1.0, 0.0, 1.0, 1.0, 1.0, 2.0;
  const Eigen::VectorXd y = Eigen::Vector3d(1.0, 2.0, 4.0);
  const Eigen::VectorXd expected = Eigen::Vector2d(5.0 / 6.0, 1.5);
  EXPECT_TRUE(HouseholderQr(A).solve(y).isApprox(expected, 1e-14));
  EXPECT_TRUE(HouseholderQr(A).solve(Eigen::MatrixXd(y)).isApprox(expected, 1e-14));
  EXPECT_TRUE(least_squares(A, y).isApprox(expected, 1e-14));
  EXPECT_TRUE(shortest_least_squares(A, y).isApprox(expected, 1e-14));
}

// x_1 + x_2 = 2 twice: of all solutions (1, 1) is the shortest.
TEST(ShortestLeastSquares, PicksTheShortestSolutionWhereThereAreMany) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Ones(2, 2);
  EXPECT_TRUE(
      shortest_least_squares(A, Eigen::VectorXd(Eigen::Vector2d(2.0, 2.0))).isApprox(Eigen::Vector2d(1.0, 1.0), 1e-14));
  const Eigen::MatrixXd B = Eigen::MatrixXd::Constant(2, 1, 2.0);
  EXPECT_TRUE(shortest_least_squares(A, B, 1e-10).isApprox(Eigen::Vector2d(1.0, 1.0), 1e-14));
}

// Rows that no unknown of A reaches keep the part of B that A cannot explain.
TEST(Eliminate, FindsTheRankAndLeavesWhatTheMatrixCannotExplain) {
  Eigen::MatrixXd A(4, 2);
  A << 1.0, 2.0, 1.0, 2.0, 1.0, 2.0, 1.0, 2.0;  // rank 1
  const Eigen::MatrixXd B = Eigen::MatrixXd::Random(4, 1);
  const Eliminated result = eliminate(A, B, 1e-10);
  EXPECT_EQ(result.rank, 1);
  const double mean = B.mean();
  EXPECT_NEAR(result.rest.bottomRows(3).norm(), (B.array() - mean).matrix().norm(), 1e-13);
}

TEST(SolveLinear, SolvesARegularSystem) {
  Eigen::MatrixXd A(2, 2);
  A << 0.0, 1.0, 2.0, 3.0;  // needs pivoting
  const Eigen::VectorXd b = Eigen::Vector2d(5.0, 7.0);
  EXPECT_TRUE(solve_linear(A, b).isApprox(Eigen::Vector2d(-4.0, 5.0), 1e-14));
  EXPECT_TRUE(solve_linear(A, Eigen::MatrixXd(b)).isApprox(Eigen::Vector2d(-4.0, 5.0), 1e-14));
}

// Second row twice the first: of all solutions the shortest, and a pivot below the threshold counts as zero.
TEST(ShortestLeastSquares, TakesPivotsBelowTheThresholdForZero) {
  Eigen::MatrixXd A(2, 2);
  A << 1.0, 1.0, 2.0, 2.0 + 1e-6;
  const Eigen::VectorXd b = Eigen::Vector2d(1.0, 2.0);
  EXPECT_TRUE(shortest_least_squares(A, b, 1e-3).isApprox(Eigen::Vector2d(0.5, 0.5), 1e-6));
  EXPECT_TRUE(shortest_least_squares(A, b).isApprox(Eigen::Vector2d(1.0, 0.0), 1e-6));
}

TEST(Inverse, IsNothingForASingularMatrix) {
  Eigen::MatrixXd A(2, 2);
  A << 0.0, 2.0, 4.0, 6.0;
  const std::optional<Eigen::MatrixXd> back = inverse(A);
  ASSERT_TRUE(back);
  EXPECT_TRUE((*back * A).isIdentity(1e-14));
  A << 1.0, 2.0, 2.0, 4.0 + 1e-15;
  EXPECT_FALSE(inverse(A));
}

}  // namespace
}  // namespace veridyn::numerics
