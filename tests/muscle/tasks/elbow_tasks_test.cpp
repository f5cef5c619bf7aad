#include "veridyn/muscle/tasks/elbow_tasks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

using ::testing::HasSubstr;

TEST(ElbowTasks, AreCountedAsPublished) {
  // Number, shoulder, from, to in degrees.
  const std::vector<std::array<double, 4>> published{{1, -90, 0, 90},  {4, -45, 0, 90},    {21, 180, 90, 130},
                                                     {22, -90, 90, 0}, {42, 180, 130, 90}, {2, -90, 0, 130},
                                                     {11, 45, 0, 130}, {32, 45, 130, 0}};
  for (const auto& [number, shoulder, from, to] : published) {
    const ElbowTask task = elbow_task(static_cast<int>(number));
    EXPECT_DOUBLE_EQ(task.shoulder, shoulder * kDegree) << number;
    EXPECT_DOUBLE_EQ(task.from, from * kDegree) << number;
    EXPECT_DOUBLE_EQ(task.to, to * kDegree) << number;
  }
  EXPECT_EQ(elbow_task_name(42), "task 42: extension 130-90 deg, shoulder 180 deg");
  EXPECT_THROW(static_cast<void>(elbow_task(0)), InputError);
  EXPECT_THROW(static_cast<void>(elbow_task(43)), InputError);
}

TEST(ElbowTasks, FollowTheHalfSineRampAfterTheStart) {
  const Model model = load_model("arm").model();
  const ElbowTaskOptions options = resolved(model, {});
  EXPECT_EQ(options.elbow, "elbow_flexion");
  EXPECT_EQ(options.shoulder, "shoulder_flexion");
  EXPECT_EQ(options.load_body, "forearm");
  EXPECT_NEAR(options.load_location->y(), -0.34, 1e-12);
  const Task task = make_elbow_task(model, options, 8);  // flexion 0-130, shoulder 0
  ASSERT_EQ(task.held.size(), 1u);
  EXPECT_EQ(task.held[0].value, 0.0);
  ASSERT_EQ(task.loads.size(), 1u);
  EXPECT_EQ(task.loads[0].mass, 1.0);
  const double q1 = 0.0, q2 = model.coordinates[1].high, T = 0.03;
  for (const double t : {0.0, 0.03, 0.2, 0.53, 0.9, 1.03, 1.2}) {
    const double s = std::clamp(t - T, 0.0, 1.0);
    const double expected = (q2 - q1) / 2.0 * std::sin(kPi * s - kPi / 2.0) + (q1 + q2) / 2.0;
    EXPECT_NEAR(task.desired.coordinate[1]->evaluate(t).value, expected, 1e-9) << t;
  }
  EXPECT_DOUBLE_EQ(task.end, 1.03);
}

TEST(ElbowTasks, ThatAModelCannotPerformAreNamed) {
  const Model model = load_model("arm").model();
  const ElbowTaskOptions options = resolved(model, {});
  EXPECT_THAT(obstacle(model, options, 1), HasSubstr("shoulder_flexion"));
  EXPECT_EQ(obstacle(model, options, 8), "");
  EXPECT_THROW(static_cast<void>(make_elbow_task(model, options, 1)), InputError);
  int possible = 0;
  for (int n = 1; n <= kElbowTasks; ++n) possible += obstacle(model, options, n).empty() ? 1 : 0;
  EXPECT_EQ(possible, 30);  // shoulder -45 .. 135 deg
}

TEST(ElbowTasks, CoordinatesThatAreNotThereOrNotClearAreNamed) {
  Model model = load_model("arm").model();
  try {
    static_cast<void>(resolved(model, {.elbow = "elbow_flexio"}));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("elbow_flexion"));
  }
  model.coordinates[0].name = "elbow_side";
  EXPECT_THROW(static_cast<void>(resolved(model, {})), InputError);
  EXPECT_THROW(static_cast<void>(resolved(load_model("arm").model(), {.load_body = "hand"})), InputError);
}

}  // namespace
}  // namespace veridyn::muscle
