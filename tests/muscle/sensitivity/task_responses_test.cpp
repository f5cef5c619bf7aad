#include "veridyn/muscle/sensitivity/task_responses.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/muscle/sensitivity/sampled_arm.hpp"
#include "veridyn/numerics/batches/block_store.hpp"

namespace veridyn::muscle {
namespace {

using test::four_tasks;
using test::SampledArm;

TEST(TaskResponses, OfTheModelsOwnMusclesAreNone) {
  const SampledArm& s = four_tasks();
  const TaskResponses responses(s.arm, muscle_factors(s.arm.model(), 3, 0.05), s.tasks, 1e-6);
  ASSERT_EQ(responses.tasks(), 4U);
  for (std::size_t task = 0; task < 4; ++task) {
    EXPECT_EQ(responses.nrmse(task, Eigen::Vector3d::Ones()), 0.0);
    EXPECT_EQ(responses.target(task).rows(), static_cast<Eigen::Index>(s.tasks[task].time.size()));
  }
  // A weaker muscle moves the task less far than a much weaker one.
  const double weaker = responses.nrmse(1, Eigen::Vector3d(0.98, 1.0, 1.0)),
               weakest = responses.nrmse(1, Eigen::Vector3d(0.95, 1.0, 1.0));
  EXPECT_GT(weaker, 0.0);
  EXPECT_GT(weakest, weaker);
}

TEST(TaskResponses, AreNoneOfATaskThatCannotBePerformed) {
  SampledArm s({8, 11});
  s.tasks[0].trouble = "diverged";
  const TaskResponses responses(s.arm, muscle_factors(s.arm.model(), 3, 0.05), s.tasks, 1e-5);
  EXPECT_EQ(responses.target(0).size(), 0);
  EXPECT_TRUE(std::isnan(responses.nrmse(0, Eigen::Vector3d::Ones())));
  EXPECT_EQ(responses.nrmse(1, Eigen::Vector3d::Ones()), 0.0);
}

TEST(TaskResponses, OfManyPointsAreThoseOfEach) {
  const SampledArm& s = four_tasks();
  const TaskResponses responses(s.arm, muscle_factors(s.arm.model(), 3, 0.05), s.tasks, 1e-5);
  Eigen::MatrixXd points(2, 3);
  points << 0.97, 1.02, 1.0, 1.03, 0.99, 1.01;
  numerics::BlockStore nothing;
  Progress progress;
  const std::vector<std::size_t> tasks = {2, 0};
  const ResponseTable table = respond(responses, points, tasks, nothing, "test", progress);
  EXPECT_TRUE(table.completed);
  EXPECT_EQ(table.simulations, 4U);
  for (Eigen::Index point = 0; point < 2; ++point) {
    for (std::size_t t = 0; t < 2; ++t) EXPECT_EQ(table.nrmse(point, t), responses.nrmse(tasks[t], points.row(point)));
  }
}

TEST(MuscleSensitivity, FingerprintsFollowTheMotionsAndTheUnknowns) {
  const SampledArm& s = four_tasks();
  const auto print = [&](std::size_t muscle, std::size_t tasks, double accuracy) {
    const std::vector<MuscleUnknown> unknowns = muscle_factors(s.arm.model(), muscle, 0.05);
    return TaskResponses(s.arm, unknowns, std::span(s.tasks).first(tasks), accuracy).fingerprint();
  };
  EXPECT_EQ(print(0, 2, 1e-5), print(0, 2, 1e-5));
  EXPECT_NE(print(0, 2, 1e-5), print(1, 2, 1e-5));
  EXPECT_NE(print(0, 2, 1e-5), print(0, 1, 1e-5));
  EXPECT_NE(print(0, 2, 1e-5), print(0, 2, 1.1e-5));
}

}  // namespace
}  // namespace veridyn::muscle
