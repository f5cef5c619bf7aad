#include "veridyn/muscle/identification/normalised_fiber_lengths.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

/// The built-in arm with all lengths of its bones times `factor`; its muscles keep their fibre and tendon lengths, as
/// after a geometric scaling only.
Model larger_arm(double factor) {
  Model arm = load_model("arm").model();
  for (Joint& joint : arm.joints) {
    joint.parent_frame.translation *= factor;
    joint.child_frame.translation *= factor;
  }
  for (WrapObject& wrap : arm.wrap_objects) {
    wrap.placement.translation *= factor;
    wrap.dimensions *= factor;
  }
  for (Muscle& muscle : arm.muscles) {
    for (PathPoint& point : muscle.points) point.location *= factor;
  }
  return arm;
}

TEST(NormalisedFiberLengths, OfAScaledModelAreThoseOfItsReference) {
  const MusculoskeletalSystem reference(load_model("arm").model()), subject(larger_arm(1.13));
  const std::vector<MatchedFiber> matched = match_fiber_lengths(reference, subject);
  ASSERT_EQ(matched.size(), 6U);
  for (const MatchedFiber& fiber : matched) {
    ASSERT_TRUE(fiber.usable()) << fiber.obstacle;
    const MusculotendonParameters<double>& p =
        reference.muscles().settings(static_cast<std::size_t>(fiber.muscle)).musculotendon;
    EXPECT_NEAR(fiber.optimal_fiber_length / p.optimal_fiber_length, 1.13, 1e-6) << fiber.muscle;
    EXPECT_NEAR(fiber.tendon_slack_length / p.tendon_slack_length, 1.13, 1e-6) << fiber.muscle;
    EXPECT_LT(fiber.error, 1e-6) << fiber.muscle;
    EXPECT_GE(fiber.poses, 100U);
  }
}

TEST(NormalisedFiberLengths, AreFoundForRigidTendonsToo) {
  Model standard = load_model("arm").model(), larger = larger_arm(0.9);
  for (Model* model : {&standard, &larger}) {
    for (Muscle& muscle : model->muscles) muscle.parameters.rigid_tendon = true;
  }
  const MusculoskeletalSystem reference(standard), subject(larger);
  for (const MatchedFiber& fiber : match_fiber_lengths(reference, subject)) {
    ASSERT_TRUE(fiber.usable()) << fiber.obstacle;
    const double own =
        reference.muscles().settings(static_cast<std::size_t>(fiber.muscle)).musculotendon.tendon_slack_length;
    EXPECT_NEAR(fiber.tendon_slack_length / own, 0.9, 1e-6) << fiber.muscle;
  }
}

// Another attachment: no lengths give the reference's curve, and the error says how far they are from it.
TEST(NormalisedFiberLengths, ErrorIsWhatNoLengthsMakeUpFor) {
  Model other = load_model("arm").model();
  const int muscle = other.muscle("brachialis");
  other.muscles[muscle].points.back().location.x() += 0.012;
  const MusculoskeletalSystem reference(load_model("arm").model()), subject(other);
  const std::vector<MatchedFiber> matched = match_fiber_lengths(reference, subject);
  for (const MatchedFiber& fiber : matched) {
    if (fiber.muscle == muscle) {
      EXPECT_GT(fiber.error, 5e-3);
    } else {
      EXPECT_LT(fiber.error, 1e-6);
    }
  }
}

TEST(NormalisedFiberLengths, SayWhyAMuscleHasNoMatch) {
  Model renamed = load_model("arm").model();
  renamed.muscles[2].parameters.name = "another";
  Model slack = load_model("arm").model();
  slack.muscles[0].parameters.musculotendon.tendon_slack_length *= 3.0;
  const MusculoskeletalSystem arm(load_model("arm").model()), reference(slack), subject(renamed);
  EXPECT_THAT(match_fiber_lengths(arm, subject)[2].obstacle, ::testing::HasSubstr("no muscle of that name"));
  EXPECT_THAT(match_fiber_lengths(reference, arm)[0].obstacle, ::testing::HasSubstr("tendon is taut"));
}

}  // namespace
}  // namespace veridyn::muscle
