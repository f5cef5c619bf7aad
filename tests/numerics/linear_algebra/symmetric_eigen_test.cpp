#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace veridyn::numerics {
namespace {

Eigen::MatrixXd second_difference(Eigen::Index n) {
  Eigen::MatrixXd A = 2.0 * Eigen::MatrixXd::Identity(n, n);
  A.diagonal(1).setConstant(-1.0);
  A.diagonal(-1).setConstant(-1.0);
  return A;
}

// Closed form: 2 - 2 cos(k pi / (n + 1)), k = 1 ... n.
TEST(SymmetricEigen, FindsTheEigenvaluesOfTheSecondDifference) {
  constexpr Eigen::Index kSize = 9;
  const SymmetricEigen eigen = symmetric_eigen(second_difference(kSize));
  for (Eigen::Index k = 0; k < kSize; ++k) {
    const double angle = static_cast<double>(k + 1) * std::numbers::pi / static_cast<double>(kSize + 1);
    EXPECT_NEAR(eigen.values(k), 2.0 - 2.0 * std::cos(angle), 1e-14);
  }
  EXPECT_TRUE((eigen.values - symmetric_eigenvalues(second_difference(kSize))).isZero(1e-14));
}

TEST(SymmetricEigen, IsPutTogetherAgainByItsValuesAndVectors) {
  const Eigen::MatrixXd A = second_difference(7);
  const SymmetricEigen eigen = symmetric_eigen(A);
  EXPECT_TRUE(from_eigen(eigen.vectors, eigen.values).isApprox(A, 1e-14));
  EXPECT_TRUE((eigen.vectors.transpose() * eigen.vectors).isIdentity(1e-14));
}

TEST(SymmetricEigen, OfAMatrixWithoutRowsIsEmpty) {
  EXPECT_EQ(symmetric_eigen(Eigen::MatrixXd(0, 0)).values.size(), 0);
  EXPECT_EQ(symmetric_eigenvalues(Eigen::MatrixXd(0, 0)).size(), 0);
}

}  // namespace
}  // namespace veridyn::numerics
