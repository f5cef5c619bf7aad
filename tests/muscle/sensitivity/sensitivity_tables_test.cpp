#include "veridyn/muscle/sensitivity/sensitivity_tables.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/muscle/sensitivity/muscle_sensitivity.hpp"

namespace veridyn::muscle {
namespace {

/// Two muscles in an elbow task and in one of the study's own, which none of the simulations finished.
MuscleSensitivity two_tasks() {
  MuscleSensitivity s;
  s.muscles = {"flexor", "extensor"};
  s.tasks = {{.name = "curl, slow", .number = 8, .wrap_bands = {"flexor fades", "extensor fades"}},
             {.name = "own", .obstacle = "it diverges", .failed = 8}};
  s.sampling.samples = 4;
  s.sampling.mean = Eigen::Matrix2d{{0.25, NAN}, {0.5, NAN}};
  s.sampling.sd = Eigen::Matrix2d{{0.125, NAN}, {0.0, NAN}};
  s.sampling.greatest = Eigen::Matrix2d{{0.375, NAN}, {0.5, NAN}};
  s.sampling.failed = Eigen::Matrix2i{{0, 4}, {1, 4}};
  s.cover.chosen = TaskSet{.tasks = {0}};
  s.cover.runner_up = TaskSet{.tasks = {0, 1}};
  s.cover.excites = {{0, 1}, {}};
  return s;
}

TEST(SensitivityTables, HaveARowOfEachMuscleInEachTaskAndEmptyCellsWhereNothingFinished) {
  EXPECT_EQ(sensitivity_csv(two_tasks()),
            "task,muscle,mean_nrmse,sd_nrmse,greatest_nrmse,samples,failed\n"
            "\"curl, slow\",flexor,0.25,0.125,0.375,4,0\n"
            "\"curl, slow\",extensor,0.5,0,0.5,4,1\n"
            "own,flexor,,,,4,4\n"
            "own,extensor,,,,4,4\n");
}

TEST(SensitivityTables, SayOfEachTaskWhatItIsChosenFor) {
  std::vector<PreparedTask> tasks(2);
  tasks[0].tracking_error = 0.5;
  tasks[0].reserve_share = 0.25;
  tasks[1].overloaded = 3;
  EXPECT_EQ(task_choice_csv(two_tasks(), tasks),
            "task,chosen,runner_up,excites,obstacle,wrap_bands,failed,tracking_error[rad],reserve_share,"
            "overloaded_windows\n"
            "\"curl, slow\",yes,yes,flexor extensor,,flexor fades; extensor fades,0,0.5,0.25,0\n"
            "own,no,yes,,it diverges,,8,0,0,3\n");
}

TEST(SensitivityTables, NameElbowTasksByNumberAndOthersByName) {
  EXPECT_EQ(task_list(two_tasks(), TaskSet{.tasks = {0, 1}}), "8, \"own\"");
  EXPECT_EQ(task_list(two_tasks(), TaskSet{}), "");
}

}  // namespace
}  // namespace veridyn::muscle
