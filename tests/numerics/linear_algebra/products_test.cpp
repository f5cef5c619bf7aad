#include "veridyn/numerics/linear_algebra/products.hpp"

#include <gtest/gtest.h>

namespace veridyn::numerics {
namespace {

TEST(Products, AreWhatTheirNamesSayElementByElement) {
  Eigen::MatrixXd A(2, 3), B(3, 2);
  A << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0;
  B << 7.0, 8.0, 9.0, 10.0, 11.0, 12.0;
  Eigen::MatrixXd expected(2, 2);
  expected << 58.0, 64.0, 139.0, 154.0;
  EXPECT_EQ(product(A, B), expected);
  EXPECT_EQ(transposed_product(A.transpose(), B), expected);
  EXPECT_EQ(product_transposed(A, B.transpose()), expected);
  EXPECT_EQ(product(A, B, A), product(expected, A));
}

TEST(Products, ScaleRowsAndColumns) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Ones(2, 3);
  Eigen::MatrixXd expected(2, 3);
  expected << 10.0, 20.0, 30.0, 20.0, 40.0, 60.0;
  EXPECT_EQ(scaled(Eigen::Vector2d(1.0, 2.0), A, Eigen::Vector3d(10.0, 20.0, 30.0)), expected);
}

TEST(SolveUpper, ReadsTheUpperTriangleOnly) {
  Eigen::MatrixXd R(2, 2);
  R << 2.0, 1.0, 99.0, 4.0;
  EXPECT_EQ(solve_upper(R, Eigen::VectorXd(Eigen::Vector2d(4.0, 8.0))), Eigen::Vector2d(1.0, 2.0));
  EXPECT_EQ(solve_upper(R, Eigen::MatrixXd(Eigen::Vector2d(4.0, 8.0))), Eigen::MatrixXd(Eigen::Vector2d(1.0, 2.0)));
}

}  // namespace
}  // namespace veridyn::numerics
