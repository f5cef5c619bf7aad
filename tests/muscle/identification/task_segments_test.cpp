#include "veridyn/muscle/identification/task_segments.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "veridyn/muscle/identification/muscle_parametric_model.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/tasks/elbow_tasks.hpp"

namespace veridyn::muscle {
namespace {

class TaskSegments : public testing::Test {
 protected:
  static std::vector<PreparedTask> prepared(const MusculoskeletalSystem& arm) {
    std::vector<Task> list;
    for (const int n : {8, 33}) list.push_back(make_elbow_task(arm.model(), resolved(arm.model(), {}), n));
    Progress progress;
    return prepare_tasks(arm, std::move(list), progress);
  }
  MusculoskeletalSystem arm{load_model("arm").model(), {.paths = PathSource::kFitted}};
  std::vector<PreparedTask> tasks = prepared(arm);
};

TEST_F(TaskSegments, AreTheTasksInTheirOwnSystems) {
  const std::vector<MotionSegment> segments = segments_of(tasks);
  ASSERT_EQ(segments.size(), 2U);
  for (std::size_t s = 0; s < 2; ++s) {
    EXPECT_EQ(segments[s].time, tasks[s].time);
    EXPECT_EQ(segments[s].start.q, tasks[s].start.q);
    EXPECT_EQ(segments[s].system, tasks[s].system.get());
    EXPECT_EQ(segments[s].name, tasks[s].task.name);
  }
  tasks[1].trouble = "diverged at 0.3 s";
  try {
    static_cast<void>(segments_of(tasks));
    FAIL() << "a task with trouble has no segment";
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(error.what(), tasks[1].task.name + ": diverged at 0.3 s");
  }
}

TEST_F(TaskSegments, AreSimulatedAlikeOnAnyNumberOfThreadsAndEmptyWhereTheyCannotBe) {
  const MuscleUnknown force =
      make_unknown(arm.model(), {.muscles = {"brachialis"}, .fields = {"max_isometric_force"}, .factor = true}, "test");
  const MuscleParametricModel model(arm, std::vector<MuscleUnknown>{force}, segments_of(tasks), {.accuracy = 1e-5});
  const Eigen::VectorXd weaker = Eigen::VectorXd::Constant(1, 0.9);
  const std::vector<estimation::RowMatrix> one = simulate_tasks(model, weaker, 1);
  EXPECT_EQ(one, simulate_tasks(model, weaker, 2));
  for (std::size_t s = 0; s < 2; ++s) {
    // A response starts where its segment does: those values follow the parameters.
    Eigen::VectorXd all = weaker;
    for (const estimation::ModelParameter& start : model.initial_conditions(s)) {
      all.conservativeResize(all.size() + 1);
      all(all.size() - 1) = start.start;
    }
    estimation::ModelResponse response;
    ASSERT_TRUE(model.respond(s, all, {}, response));
    EXPECT_EQ(one[s], response.output);
    EXPECT_EQ(one[s].rows(), static_cast<Eigen::Index>(tasks[s].time.size()));
  }
  // No muscle pulls with less than nothing.
  for (const estimation::RowMatrix& outputs : simulate_tasks(model, Eigen::VectorXd::Constant(1, -1.0), 1))
    EXPECT_EQ(outputs.size(), 0);
}

}  // namespace
}  // namespace veridyn::muscle
