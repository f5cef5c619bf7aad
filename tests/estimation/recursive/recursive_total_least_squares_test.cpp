#include "veridyn/estimation/recursive/recursive_total_least_squares.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "veridyn/estimation/regression/total_least_squares.hpp"

namespace veridyn::estimation {
namespace {

constexpr int kStreamColumns = 5;
constexpr double kStreamWeight = 0.99;

/// Errors of a constant and a deflection that are exact, of two regressors and of z that are not.
Eigen::MatrixXd stream_errors() {
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(kStreamColumns, kStreamColumns);
  W.diagonal() << 0.0, 0.0, 0.04, 0.02, 0.1;
  W(2, 3) = W(3, 2) = 0.01;
  return W;
}

/// Rows, weighted as they are after the last of them.
struct Stream {
  RecursiveTotalLeastSquares tracked{stream_errors()};
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(kStreamColumns, kStreamColumns);  ///< D'D

  void append(const std::array<double, kStreamColumns>& row) {
    ASSERT_TRUE(tracked.append(row.data(), kStreamWeight));
    const Eigen::Map<const Eigen::VectorXd> d(row.data(), kStreamColumns);
    square = (kStreamWeight * square + d * d.transpose()).eval();
  }
};

Stream random_stream() {
  Stream s;
  std::mt19937_64 generator(4);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 300; ++k)
    s.append({1.0, normal(generator), normal(generator), 2.0 * normal(generator), normal(generator)});
  return s;
}

TEST(RecursiveTotalLeastSquares, IsTheWhitenedTriangleOfTheWeightedRows) {
  const Stream s = random_stream();
  SmallMatrix A;
  s.tracked.square_root(A);
  EXPECT_LT((A.transpose() * A - s.square).norm(), 1e-11 * s.square.norm());
  const Eigen::MatrixXd triangle = Eigen::LLT<Eigen::MatrixXd>(s.square).matrixU();
  const Eigen::VectorXd batch = whiten(triangle, stream_errors()).singular_values;
  ASSERT_EQ(s.tracked.noisy_columns(), 3);
  ASSERT_EQ(batch.size(), 3);
  for (int j = 0; j < 3; ++j) EXPECT_NEAR(s.tracked.singular_value(j) / batch(j), 1.0, 1e-11);
}

// What the class says of its vectors, each from D'D and W.
TEST(RecursiveTotalLeastSquares, BasesAreOrthogonalInTheDataAndOfUnitErrors) {
  const Stream s = random_stream();
  ASSERT_EQ(s.tracked.exact_rank(), 2);
  Eigen::MatrixXd B(kStreamColumns, 5);
  for (int j = 0; j < 3; ++j) s.tracked.basis(j, B.col(j).data());
  for (int i = 0; i < 2; ++i) s.tracked.exact_basis(i, B.col(3 + i).data());
  Eigen::VectorXd power(5);
  for (int j = 0; j < 3; ++j) power(j) = std::pow(s.tracked.singular_value(j), 2);
  power.tail(2).setOnes();
  const Eigen::MatrixXd in_data = B.transpose() * s.square * B, in_errors = B.transpose() * stream_errors() * B;
  EXPECT_LT((in_data - Eigen::MatrixXd(power.asDiagonal())).norm(), 1e-10 * power.norm());
  EXPECT_LT((in_errors.topLeftCorner(3, 3) - Eigen::MatrixXd::Identity(3, 3)).norm(), 1e-12);
  EXPECT_NEAR(s.tracked.power(B.col(1).data()), power(1), 1e-10 * power(1));
  // Coordinates of a row are its products with them.
  const std::array<double, kStreamColumns> row{1.0, -0.4, 0.7, 0.2, 1.5};
  std::array<double, kMaxRecursiveColumns> along{}, along_exact{};
  s.tracked.coordinates(row.data(), along.data(), along_exact.data());
  const Eigen::VectorXd expected = B.transpose() * Eigen::Map<const Eigen::VectorXd>(row.data(), kStreamColumns);
  for (int j = 0; j < 3; ++j) EXPECT_NEAR(along[j], expected(j), 1e-11);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(along_exact[i], expected(3 + i), 1e-11);
}

TEST(RecursiveTotalLeastSquares, RowsOfErrorsAloneRaiseAllSingularValuesAlike) {
  Stream s = random_stream();
  std::array<double, 3> before{};
  for (int j = 0; j < 3; ++j) before[j] = s.tracked.singular_value(j);
  s.tracked.append_errors(40.0);
  for (int j = 0; j < 3; ++j) EXPECT_NEAR(s.tracked.singular_value(j), std::hypot(before[j], std::sqrt(40.0)), 1e-10);
  SmallMatrix A;
  s.tracked.square_root(A);
  EXPECT_LT((A.transpose() * A - s.square - 40.0 * stream_errors()).norm(), 1e-11 * s.square.norm());
}

TEST(RecursiveTotalLeastSquares, RefusesARowThatIsNotFiniteAndStaysAsItWas) {
  Stream s = random_stream();
  const std::array<double, kStreamColumns> bad{1.0, 0.0, std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0};
  EXPECT_FALSE(s.tracked.append(bad.data(), kStreamWeight));
  SmallMatrix A;
  s.tracked.square_root(A);
  EXPECT_LT((A.transpose() * A - s.square).norm(), 1e-11 * s.square.norm());
}

}  // namespace
}  // namespace veridyn::estimation
