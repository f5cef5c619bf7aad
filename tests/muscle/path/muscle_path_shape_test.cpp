// What a path looks like at one pose.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/muscle/path/posed_arm.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

using test::PosedArm;

TEST(MusclePaths, PolylinesHaveTheLengthOfTheirPathAndStayOnTheObjects) {
  PosedArm arm(load_model("arm").model());
  for (const double e : {10.0, 60.0, 110.0}) {
    arm.pose_deg(20.0, e);
    for (int m = 0; m < arm.paths.muscles(); ++m) {
      const auto line = arm.paths.polyline(arm.kinematics, arm.q.data(), m, 40);
      double length = 0.0;
      for (std::size_t i = 0; i + 1 < line.size(); ++i) length += (line[i + 1] - line[i]).norm();
      EXPECT_NEAR(length, arm.workspace.length[m], 2e-4) << m;
    }
  }
}

TEST(MusclePaths, PointInsideAWrapObjectIsNamedAndThePathStaysFinite) {
  Model model = load_model("arm").model();
  Muscle* wrapped = nullptr;
  for (Muscle& muscle : model.muscles)
    if (!muscle.wraps.empty()) wrapped = &muscle;
  ASSERT_NE(wrapped, nullptr);
  const WrapObject& object = model.wrap_objects[wrapped->wraps[0].object];
  PathPoint& point = wrapped->points[wrapped->wraps[0].first_point];
  point.body = object.body;
  point.location = object.placement.translation;
  PosedArm arm(model);
  arm.pose(model.default_pose());
  const auto inside = arm.paths.points_inside(arm.kinematics, arm.q.data());
  ASSERT_FALSE(inside.empty());
  EXPECT_EQ(model.muscles[inside[0].muscle].name(), wrapped->name());
  EXPECT_EQ(inside[0].point, point.name);
  EXPECT_EQ(inside[0].object, object.name);
  EXPECT_NEAR(inside[0].depth, object.dimensions[0], 1e-12);  // at the centre of a sphere
  for (const double length : arm.workspace.length) EXPECT_TRUE(std::isfinite(length));
  for (const double slope : arm.workspace.gradient) EXPECT_TRUE(std::isfinite(slope));
}

}  // namespace
}  // namespace veridyn::muscle
