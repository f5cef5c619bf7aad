#include "veridyn/muscle/tasks/task_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {
namespace {

estimation::RowMatrix column_matrix(std::vector<double> values) {
  return Eigen::Map<estimation::RowMatrix>(values.data(), static_cast<Eigen::Index>(values.size()), 1);
}

TEST(TaskError, IsTheRootMeanSquareOverTheRangeOfTheTarget) {
  const TaskError e = task_error(column_matrix({0.0, 1.0, 2.0, 1.0}), column_matrix({0.1, 0.9, 2.1, 0.9}));
  EXPECT_NEAR(e.rmse, 0.1, 1e-15);
  EXPECT_NEAR(e.nrmse, 0.05, 1e-15);
  EXPECT_TRUE(e.moves);
  EXPECT_DOUBLE_EQ(e.range, 2.0);
}

TEST(TaskError, ATargetThatHardlyMovesHasNoNormalisedError) {
  const TaskError e = task_error(column_matrix({0.0, 0.017, 0.0}), column_matrix({0.0, 0.0, 0.0}));
  EXPECT_FALSE(e.moves);
  EXPECT_TRUE(std::isnan(e.nrmse));
  EXPECT_NEAR(e.rmse, 0.017 / std::sqrt(3.0), 1e-15);
  EXPECT_TRUE(task_error(column_matrix({0.0, 0.018, 0.0}), column_matrix({0.0, 0.0, 0.0})).moves);
}

TEST(TaskError, ASimulationThatCannotFinishIsNaN) {
  const TaskError e = task_error(column_matrix({0.0, 1.0}), {});
  EXPECT_TRUE(std::isnan(e.rmse));
  EXPECT_TRUE(std::isnan(e.nrmse));
  EXPECT_TRUE(e.moves);
}

TEST(TaskError, SamplesWithoutANumberDoNotCount) {
  const TaskError e = task_error(column_matrix({0.0, kNaN, 1.0}), column_matrix({0.0, 5.0, 1.0}));
  EXPECT_EQ(e.rmse, 0.0);
}

TEST(TaskError, OfSeveralOutputsIsTheMeanOfThoseThatMove) {
  estimation::RowMatrix target(2, 3), predicted(2, 3);
  target << 0.0, 0.0, 1.0, 1.0, 2.0, 1.0;
  predicted << 0.1, 0.1, 1.0, 1.1, 2.1, 1.0;
  EXPECT_NEAR(task_error(target, predicted).nrmse, (0.1 + 0.05) / 2.0, 1e-15);
}

}  // namespace
}  // namespace veridyn::muscle
