#include "veridyn/muscle/tasks/task.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/identification/task_segments.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/tasks/elbow_tasks.hpp"

namespace veridyn::muscle {
namespace {

class Threads : public Progress {
 public:
  explicit Threads(int count) : count_(count) {}
  [[nodiscard]] int threads() const override { return count_; }

 private:
  int count_;
};

std::vector<Task> elbow_tasks(const Model& model, const std::vector<int>& numbers) {
  std::vector<Task> tasks;
  for (const int n : numbers) tasks.push_back(make_elbow_task(model, resolved(model, {}), n));
  return tasks;
}

TEST(PreparedTasks, TheStandardModelFollowsTheDesiredMotionAndRepeatsItsOwn) {
  const MusculoskeletalSystem arm(load_model("arm").model(), {.paths = PathSource::kFitted});
  Progress progress;
  const std::vector<PreparedTask> tasks = prepare_tasks(arm, elbow_tasks(arm.model(), {8, 12, 30}), progress);
  ASSERT_EQ(tasks.size(), 3u);
  const MuscleParametricModel model(arm, {}, segments_of(tasks), 1e-6);
  // Locked everywhere: the shoulder is no output.
  ASSERT_EQ(model.outputs().size(), 1u);
  const std::vector<estimation::RowMatrix> q = simulate_tasks(model, Eigen::VectorXd(0), 2);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    ASSERT_TRUE(tasks[i].usable()) << tasks[i].trouble;
    EXPECT_EQ(tasks[i].system->fit(), arm.fit());
    EXPECT_EQ(tasks[i].system->reduction().free().size(), 1u);
    EXPECT_LT(tasks[i].tracking_error, 2.0 * kDegree);
    EXPECT_GE(tasks[i].reserve_share, 0.0);
    EXPECT_LT(tasks[i].reserve_share, 0.2);
    ASSERT_GT(q[i].size(), 0);
    double largest = 0.0;
    for (Eigen::Index k = 0; k < q[i].rows(); ++k) {
      const double desired = tasks[i].task.desired.coordinate[1]->evaluate(tasks[i].time[k]).value;
      largest = std::max(largest, std::abs(q[i](k, 0) - desired));
    }
    EXPECT_NEAR(largest, tasks[i].tracking_error, 1e-4);
  }
}

TEST(PreparedTasks, HaveTheSameBitsOnAnyNumberOfThreads) {
  const MusculoskeletalSystem arm(load_model("arm").model(), {.paths = PathSource::kFitted});
  Threads one(1), two(2);
  const std::vector<PreparedTask> a = prepare_tasks(arm, elbow_tasks(arm.model(), {8, 12, 30, 33}), one);
  const std::vector<PreparedTask> b = prepare_tasks(arm, elbow_tasks(arm.model(), {8, 12, 30, 33}), two);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto times = a[i].controls.excitation.times();
    ASSERT_EQ(times.size(), b[i].controls.excitation.times().size());
    for (std::size_t k = 0; k < times.size(); ++k) {
      const auto x = a[i].controls.excitation.row(k), y = b[i].controls.excitation.row(k);
      EXPECT_TRUE(std::equal(x.begin(), x.end(), y.begin()));
    }
    EXPECT_EQ(a[i].start.activation, b[i].start.activation);
  }
}

TEST(PreparedTasks, ThatHoldEverythingAreRefused) {
  const MusculoskeletalSystem arm(load_model("arm").model(), {.paths = PathSource::kFitted});
  std::vector<Task> tasks = elbow_tasks(arm.model(), {8});
  tasks[0].held.push_back({1, 0.5});
  Progress progress;
  EXPECT_THROW(static_cast<void>(prepare_tasks(arm, tasks, progress)), InputError);
}

TEST(MusculoskeletalSystem, WithChangesHoldsCoordinatesAndTakesOtherMusclesAlongTheSamePaths) {
  const MusculoskeletalSystem arm(load_model("arm").model(), {.paths = PathSource::kFitted});
  SystemChanges changes{.locked = {"shoulder_flexion"}, .muscles = muscle_parameters(arm.model())};
  changes.muscles[0].rigid_tendon = true;
  const MusculoskeletalSystem changed(arm, changes);
  EXPECT_EQ(changed.reduction().free().size(), 1u);
  EXPECT_EQ(changed.layout().size, arm.layout().size - 3);  // value, speed, a fibre
  EXPECT_EQ(changed.fit(), arm.fit());
  changes.muscles[0].name = "other";
  EXPECT_THROW(MusculoskeletalSystem(arm, changes), InputError);
  EXPECT_THROW(MusculoskeletalSystem(arm, SystemChanges{.locked = {"wrist"}}), InputError);
}

}  // namespace
}  // namespace veridyn::muscle
