#include "veridyn/numerics/linear_algebra/cholesky.hpp"

#include <gtest/gtest.h>

namespace veridyn::numerics {
namespace {

Eigen::MatrixXd lower() {
  Eigen::MatrixXd L(3, 3);
  L << 2.0, 0.0, 0.0, -1.0, 3.0, 0.0, 0.5, 0.25, 1.0;
  return L;
}

TEST(Cholesky, FindsTheFactorThatMadeTheMatrix) {
  const Eigen::MatrixXd L = lower();
  const Cholesky cholesky(L * L.transpose());
  ASSERT_TRUE(cholesky.positive_definite());
  EXPECT_TRUE(cholesky.L().isApprox(L, 1e-14));
}

TEST(Cholesky, SolvesWithTheMatrixAndEachOfItsFactors) {
  const Eigen::MatrixXd L = lower(), A = L * L.transpose();
  const Cholesky cholesky(A);
  const Eigen::MatrixXd B = Eigen::MatrixXd::Random(3, 2);
  const Eigen::VectorXd b = B.col(0);
  EXPECT_TRUE((A * cholesky.solve(B)).isApprox(B, 1e-13));
  EXPECT_TRUE((A * cholesky.solve(b)).isApprox(b, 1e-13));
  EXPECT_TRUE((L * cholesky.solve_lower(B)).isApprox(B, 1e-13));
  EXPECT_TRUE((L.transpose() * cholesky.solve_upper(B)).isApprox(B, 1e-13));
}

TEST(Cholesky, SaysWhenTheMatrixIsNotPositiveDefinite) {
  Eigen::MatrixXd A(2, 2);
  A << 1.0, 2.0, 2.0, 1.0;
  EXPECT_FALSE(Cholesky(A).positive_definite());
}

TEST(PivotedCholesky, SolvesAndSaysHowFarTheMatrixIsFromIndefinite) {
  const Eigen::MatrixXd A = lower() * lower().transpose();
  const PivotedCholesky definite(A);
  const Eigen::MatrixXd B = Eigen::MatrixXd::Random(3, 2);
  const Eigen::VectorXd b = B.col(0);
  EXPECT_GT(definite.smallest_pivot(), 0.1);
  EXPECT_TRUE((A * definite.solve(B)).isApprox(B, 1e-13));
  EXPECT_TRUE((A * definite.solve(b)).isApprox(b, 1e-13));
  Eigen::MatrixXd indefinite(2, 2);
  indefinite << 1.0, 2.0, 2.0, 1.0;  // eigenvalues 3 and -1
  EXPECT_LT(PivotedCholesky(indefinite).smallest_pivot(), 0.0);
}

TEST(SolveSymmetric, SolvesADefiniteMatrixOfEitherSign) {
  const Eigen::MatrixXd A = -(lower() * lower().transpose());
  const Eigen::MatrixXd B = Eigen::MatrixXd::Random(3, 2);
  const Eigen::VectorXd b = B.col(1);
  EXPECT_TRUE((A * solve_symmetric(A, B)).isApprox(B, 1e-13));
  EXPECT_TRUE((A * solve_symmetric(A, b)).isApprox(b, 1e-13));
}

// (1, 2) [[2, 1], [1, 2]]^-1 (1, 2)' = 2.
TEST(InverseQuadraticForm, IsTheSquaredDistanceInTheMatrix) {
  Eigen::MatrixXd A(2, 2);
  A << 2.0, 1.0, 1.0, 2.0;
  EXPECT_NEAR(inverse_quadratic_form(A, Eigen::Vector2d(1.0, 2.0)), 2.0, 1e-14);
}

}  // namespace
}  // namespace veridyn::numerics
