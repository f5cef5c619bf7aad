#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

TEST(MusculoskeletalSystem, ForcesThatAreNotUnderstoodStopASimulationUnlessItIsToRunWithoutThem) {
  Model model = load_model("arm").model();
  model.unsupported.push_back({"HuntCrossleyForce", "hand_contact", true});
  try {
    const MusculoskeletalSystem system(model);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("HuntCrossleyForce 'hand_contact' would change the motion"));
  }
  const MusculoskeletalSystem system(model, {.without_unsupported = true});
  ASSERT_FALSE(system.notes().empty());
  EXPECT_THAT(system.notes().front(), ::testing::HasSubstr("hand_contact"));
}

TEST(MusculoskeletalSystem, APathPointInsideAWrapObjectIsNotedWithPoseAndDepth) {
  Model model = load_model("arm").model();
  for (Muscle& muscle : model.muscles) {
    if (muscle.wraps.empty()) continue;
    const WrapObject& object = model.wrap_objects[muscle.wraps[0].object];
    if (object.shape != WrapShape::kSphere) continue;
    PathPoint& point = muscle.points[muscle.wraps[0].first_point];
    point.body = object.body;
    point.location = object.placement * Eigen::Vector3d(object.dimensions[0] - 0.0015, 0.0, 0.0);
    const MusculoskeletalSystem system(model);
    ASSERT_EQ(system.notes().size(), 1u);
    EXPECT_THAT(system.notes()[0],
                ::testing::AllOf(::testing::HasSubstr("at the default pose (elbow_flexion = 20 deg)"),
                                 ::testing::HasSubstr("muscle " + muscle.name() + ": point " + point.name),
                                 ::testing::HasSubstr("lies 1.5 mm inside its wrap object " + object.name)));
    return;
  }
  FAIL() << "the arm has no sphere";
}

TEST(MusculoskeletalSystem, DisabledMusclesAreLeftOutAndUnknownCoordinatesNamed) {
  Model model = load_model("arm").model();
  model.muscles[2].enabled = false;
  const MusculoskeletalSystem system(model);
  EXPECT_EQ(system.muscles().size(), 5u);
  EXPECT_THROW(MusculoskeletalSystem(model, {.locked = {"elbow"}}), InputError);
}

TEST(MusculoskeletalSystem, StatesAreNamedInTheOrderOfTheLayout) {
  Model model = load_model("arm").model();
  model.muscles[1].parameters.rigid_tendon = true;
  const MusculoskeletalSystem system(model, {.locked = {"shoulder_flexion"}});
  const StateLayout& layout = system.layout();
  ASSERT_EQ(layout.size, 1u + 1u + 6u + 5u);
  ASSERT_EQ(system.scales().size(), layout.size);
  EXPECT_EQ(layout.fiber_length[1], -1);
  EXPECT_EQ(system.state_name(0), "value of coordinate 'elbow_flexion'");
  EXPECT_EQ(system.state_name(1), "speed of coordinate 'elbow_flexion'");
  EXPECT_EQ(system.state_name(2), "activation of muscle '" + model.muscles[0].name() + "'");
  EXPECT_EQ(system.state_name(9), "fibre length of muscle '" + model.muscles[2].name() + "'");
}

}  // namespace
}  // namespace veridyn::muscle
