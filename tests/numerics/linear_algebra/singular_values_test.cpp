#include "veridyn/numerics/linear_algebra/singular_values.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace veridyn::numerics {
namespace {

// [[3, 0], [4, 5]]: A'A = [[25, 20], [20, 25]] has the eigenvalues 45 and 5.
TEST(SingularValues, AreTheRootsOfTheEigenvaluesOfTheNormalMatrix) {
  Eigen::MatrixXd A(2, 2);
  A << 3.0, 0.0, 4.0, 5.0;
  const SingularValues svd = singular_values(A, SingularVectors::kNone);
  EXPECT_NEAR(svd.values(0), std::sqrt(45.0), 1e-14);
  EXPECT_NEAR(svd.values(1), std::sqrt(5.0), 1e-14);
  EXPECT_EQ(svd.U.size(), 0);
  EXPECT_EQ(svd.V.size(), 0);
}

TEST(SingularValues, GiveTheVectorsThatWereAskedForAndTheMatrixAgain) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Random(5, 3);
  const SingularValues full = singular_values(A, SingularVectors::kFullUAndV);
  EXPECT_EQ(full.U.cols(), 5);
  EXPECT_TRUE((full.U.leftCols(3) * full.values.asDiagonal() * full.V.transpose()).isApprox(A, 1e-13));
  const SingularValues thin = singular_values(A, SingularVectors::kThinUAndFullV);
  EXPECT_EQ(thin.U.cols(), 3);
  EXPECT_TRUE((thin.U * thin.values.asDiagonal() * thin.V.transpose()).isApprox(A, 1e-13));
  const SingularValues right = singular_values(A, SingularVectors::kFullV);
  EXPECT_EQ(right.U.size(), 0);
  EXPECT_TRUE((right.V.transpose() * right.V).isIdentity(1e-13));
}

// Columns of very different size: bidiagonalisation would lose the small value's digits, Jacobi keeps them.
TEST(SingularValues, KeepTheDigitsOfTheSmallestOne) {
  Eigen::MatrixXd A(2, 2);
  A << 1.0, 1e-12, 1.0, -1e-12;
  const SingularValues svd = singular_values(A, SingularVectors::kNone);
  EXPECT_NEAR(svd.values(1) / (std::sqrt(2.0) * 1e-12), 1.0, 1e-12);
}

TEST(SingularValues, AreNoneWithoutRowsOrColumns) {
  for (const auto& [rows, columns] : {std::pair{0, 3}, std::pair{3, 0}, std::pair{0, 0}}) {
    const Eigen::MatrixXd A(rows, columns);
    EXPECT_EQ(singular_values(A, SingularVectors::kNone).values.size(), 0) << rows << " x " << columns;
    const SingularValues full = singular_values(A, SingularVectors::kFullUAndV);
    EXPECT_TRUE(full.U.rows() == rows && full.U.isIdentity(0.0));
    EXPECT_TRUE(full.V.rows() == columns && full.V.isIdentity(0.0));
    const SingularValues thin = singular_values(A, SingularVectors::kThinUAndFullV);
    EXPECT_EQ(thin.U.rows(), rows);
    EXPECT_EQ(thin.U.cols(), 0);
    EXPECT_EQ(thin.V.rows(), columns);
  }
}

}  // namespace
}  // namespace veridyn::numerics
