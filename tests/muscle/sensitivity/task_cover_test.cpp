#include "veridyn/muscle/sensitivity/task_cover.hpp"

#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::muscle {
namespace {

using Tasks = std::vector<std::size_t>;

/// Tasks 0 to 4 of three muscles. Muscle 0 needs task 0 or 3, muscle 1 task 1 or 4, muscle 2 task 2 or (less) 3.
Eigen::MatrixXd three_by_five() {
  Eigen::MatrixXd nrmse(3, 5);
  nrmse << 0.10, 0.01, 0.00, 0.08, 0.02,  //
      0.00, 0.20, 0.02, 0.03, 0.15,       //
      0.01, 0.00, 0.40, 0.30, 0.10;
  return nrmse;
}

TEST(TaskCover, TakesAsFewTasksAsExciteEveryMuscle) {
  const TaskCover cover = choose_tasks(three_by_five(), std::vector<bool>(5, true), {.tasks = 0});
  ASSERT_TRUE(cover.chosen && cover.runner_up);
  // 3 gives muscle 0 80 % and muscle 2 75 %; with 1 muscle 1 has 100 %, with 4 75 %.
  EXPECT_EQ(cover.chosen->tasks, (Tasks{1, 3}));
  EXPECT_EQ(cover.runner_up->tasks, (Tasks{3, 4}));
  EXPECT_NEAR(cover.chosen->weakest, 0.75, 1e-12);
  EXPECT_EQ(cover.chosen->weakest_muscle, 2U);
  // Shares of task 1: 0.1, 1, 0; of task 3: 0.8, 0.15, 0.75.
  EXPECT_NEAR(cover.chosen->overall, 2.8 / 6.0, 1e-12);
  EXPECT_NEAR(cover.chosen->mean, (0.8 + 1.0 + 0.75) / 3.0, 1e-12);
  EXPECT_EQ(cover.missed, 0U);
  EXPECT_EQ(cover.excites[3], (Tasks{0, 2}));
}

TEST(TaskCover, StrengthensTheWeakestMuscleWithMoreTasks) {
  const TaskCover cover = choose_tasks(three_by_five(), std::vector<bool>(5, true), {.tasks = 3});
  EXPECT_EQ(cover.chosen->tasks, (Tasks{0, 1, 2}));
  EXPECT_NEAR(cover.chosen->weakest, 1.0, 1e-12);
}

TEST(TaskCover, AvoidsTasksThatAreNotAllowed) {
  const TaskCover cover = choose_tasks(three_by_five(), {true, true, true, false, true}, {.tasks = 2});
  // Without task 3 no two tasks excite all three muscles.
  EXPECT_EQ(cover.missed, 1U);
  EXPECT_EQ(cover.chosen->excited, 2U);
  EXPECT_FALSE(choose_tasks(three_by_five(), std::vector<bool>(5, false)).chosen);
}

TEST(TaskCover, LeavesOutMusclesThatNoTaskMoves) {
  Eigen::MatrixXd nrmse(2, 3);
  nrmse << 0.1, 0.2, 0.3, 1e-5, std::nan(""), 2e-5;
  const TaskCover cover = choose_tasks(nrmse, std::vector<bool>(3, true), {.tasks = 1});
  EXPECT_EQ(cover.unexcited, Tasks{1});
  EXPECT_EQ(cover.chosen->tasks, Tasks{2});
  EXPECT_EQ(cover.runner_up->tasks, Tasks{1});
}

TEST(TaskCover, ComesToTheBestOfAllSetsByExchangesMostly) {
  // 40 tasks, of which 6 are chosen: 3.8 million sets, too many to compare. Against random sets.
  numerics::RandomStream random(3, "cover");
  Eigen::MatrixXd nrmse(8, 40);
  for (double& value : nrmse.reshaped()) value = 0.01 + 0.2 * std::pow(random.uniform(), 3);
  const TaskCover cover = choose_tasks(nrmse, std::vector<bool>(40, true), {.tasks = 6});
  EXPECT_FALSE(cover.exhaustive);
  EXPECT_EQ(cover.chosen->tasks.size(), 6U);
  EXPECT_EQ(cover.missed, 0U);
  for (int trial = 0; trial < 20000; ++trial) {
    double weakest = 1.0;
    Tasks set;
    while (set.size() < 6) set.push_back(random.index(40));
    for (Eigen::Index m = 0; m < 8; ++m) {
      double most = 0.0;
      for (const std::size_t t : set) most = std::max(most, nrmse(m, t));
      weakest = std::min(weakest, most / nrmse.row(m).maxCoeff());
    }
    EXPECT_LE(weakest, cover.chosen->weakest);
  }
}

TEST(TaskCover, RefusesOptionsOutOfRange) {
  EXPECT_THROW((void)choose_tasks(three_by_five(), std::vector<bool>(5, true), {.share = 0.0}), InputError);
  EXPECT_THROW((void)choose_tasks(three_by_five(), std::vector<bool>(5, true), {.least_nrmse = std::nan("")}),
               InputError);
}

}  // namespace
}  // namespace veridyn::muscle
