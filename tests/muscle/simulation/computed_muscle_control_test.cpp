#include "veridyn/muscle/simulation/computed_muscle_control.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/muscle/minimum_jerk.hpp"
#include "tests/muscle/simulation/pedalling.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

using test::minimum_jerk;

TEST(ComputedMuscleControl, FollowsAMotionAndItsReplayIsItself) {
  const MusculoskeletalSystem system(load_model("arm").model());
  const Motion motion = minimum_jerk(system.model(), 0.3, 1.6);
  Progress progress;
  const ControlOptions options{.end = 1.0};
  const ControlResult r = computed_muscle_control(system, motion, options, progress);
  ASSERT_TRUE(r.usable()) << r.trajectory.message();
  EXPECT_LT(r.tracking_error(0), 3e-3);
  EXPECT_LT(r.tracking_error(1), 3e-3);
  const MuscleTrajectory replay =
      simulate_forward(system, r.start, r.controls, {.end = 1.0, .accuracy = options.accuracy}, progress);
  EXPECT_EQ(replay.q, r.trajectory.q);
  // The motion is the controls', not the step sizes': found at a finer accuracy, a finer replay yet stays with it.
  const ControlResult fine = computed_muscle_control(system, motion, {.end = 0.5, .accuracy = 1e-9}, progress);
  const MuscleTrajectory finer =
      simulate_forward(system, fine.start, fine.controls, {.end = 0.5, .accuracy = 1e-10}, progress);
  EXPECT_LT((finer.q - fine.trajectory.q).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(ComputedMuscleControl, ExcitationsStayWithinTheirBounds) {
  const MusculoskeletalSystem system(load_model("arm").model());
  Progress progress;
  const ControlResult r = computed_muscle_control(system, minimum_jerk(system.model(), 0.3, 1.2),
                                                  {.end = 0.5, .min_control = 0.03, .max_control = 0.6}, progress);
  ASSERT_TRUE(r.usable());
  EXPECT_GE(r.trajectory.excitation.minCoeff(), 0.03);
  EXPECT_LE(r.trajectory.excitation.maxCoeff(), 0.6);
}

TEST(ComputedMuscleControl, MissingCoordinatesAndSenselessOptionsAreNamed) {
  const MusculoskeletalSystem system(load_model("arm").model());
  Motion motion = minimum_jerk(system.model(), 0.3, 1.2);
  motion.coordinate[1].reset();
  Progress progress;
  EXPECT_THROW(
      {
        try {
          (void)computed_muscle_control(system, motion, {}, progress);
        } catch (const InputError& error) {
          EXPECT_THAT(error.what(), ::testing::HasSubstr("'elbow_flexion' is free but not in the motion"));
          throw;
        }
      },
      InputError);
  EXPECT_THROW(
      (void)computed_muscle_control(system, minimum_jerk(system.model(), 0.3, 1.2), {.window = -1.0}, progress),
      InputError);
}

// The leg's loop leaves one motion, which two extensors follow down to the dead centre (beyond it nothing but reserves
// could slow it down). Reserves may do next to nothing.
TEST(ComputedMuscleControl, FollowsAMotionOfAClosedLoopAndItsReplayIsItself) {
  const MusculoskeletalSystem system(test::pedals());
  const MuscleTrajectory made = test::pedalling(system, 1e-8);
  ASSERT_TRUE(made.usable()) << made.message();
  Progress progress;
  const ControlOptions options{.end = 0.2, .reserve_force = 0.01};
  const ControlResult r = computed_muscle_control(system, test::motion_of(made, system.model()), options, progress);
  ASSERT_TRUE(r.usable()) << r.trajectory.message();
  EXPECT_TRUE(r.overloaded.empty());
  EXPECT_GT(made.q(0, 2) - made.q(100, 2), 1.5);
  for (int c = 0; c < 3; ++c) EXPECT_LT(r.tracking_error(c), 3e-3) << c;
  EXPECT_LT(r.trajectory.reserve.cwiseAbs().maxCoeff(), 0.1);
  const MuscleTrajectory replay =
      simulate_forward(system, r.start, r.controls, {.end = 0.2, .accuracy = options.accuracy}, progress);
  EXPECT_EQ(replay.q, r.trajectory.q);
  const ControlResult fine = computed_muscle_control(system, test::motion_of(made, system.model()),
                                                     {.end = 0.2, .reserve_force = 0.01, .accuracy = 1e-9}, progress);
  const MuscleTrajectory finer =
      simulate_forward(system, fine.start, fine.controls, {.end = 0.2, .accuracy = 1e-10}, progress);
  EXPECT_LT((finer.q - fine.trajectory.q).cwiseAbs().maxCoeff(), 1e-6);
}

}  // namespace
}  // namespace veridyn::muscle
