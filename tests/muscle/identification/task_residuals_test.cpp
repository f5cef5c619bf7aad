#include "veridyn/muscle/identification/task_residuals.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {
namespace {

// sum r_k r_k-1 / sum r_k^2 by hand; no product over the gap or from task to task.
TEST(TaskResiduals, CorrelationOfNeighboursStopsAtGapsAndTasks) {
  const estimation::RowMatrix one = (estimation::RowMatrix(4, 1) << 1.0, 2.0, kNaN, 2.0).finished();
  const estimation::RowMatrix two = (estimation::RowMatrix(2, 1) << 1.0, 1.0).finished();
  EXPECT_DOUBLE_EQ(lag1_of({one, two}), (1.0 * 2.0 + 1.0 * 1.0) / (1.0 + 4.0 + 4.0 + 1.0 + 1.0));
  EXPECT_EQ(lag1_of({(estimation::RowMatrix(2, 1) << 1.0, -1.0).finished()}), 0.0);
}

TEST(TaskResiduals, ShareIsOfTheLargestRange) {
  const estimation::RowMatrix e = estimation::RowMatrix::Constant(3, 2, 0.1);
  estimation::RowMatrix z = estimation::RowMatrix::Zero(3, 2), still = z;
  z.col(0) << 0.0, 1.0, 2.0;
  z.col(1) << 0.0, 1.0, 4.0;
  EXPECT_NEAR(share_of_motion({e, e}, {z, still}), 0.05, 1e-15);
}

TEST(TaskResiduals, SquaresAreInUnitsOfEachOutput) {
  const estimation::RowMatrix e = (estimation::RowMatrix(2, 2) << 1.0, 3.0, kNaN, 6.0).finished();
  EXPECT_DOUBLE_EQ(squares_of({e, e}, Eigen::Vector2d(0.5, 3.0)), 2.0 * (4.0 + 1.0 + 4.0));
}

}  // namespace
}  // namespace veridyn::muscle
