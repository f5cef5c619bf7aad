// Constraints of OpenSim models.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/folders.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/simulation/assembly.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"

namespace veridyn::muscle {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Two bodies on free joints and constraints.
std::string constrained_bodies(const std::string& constraints) {
  return R"(<?xml version="1.0"?><OpenSimDocument Version="40000"><Model name="m"><BodySet><objects>
<Body name="a"><mass>1</mass><inertia>1 1 1 0 0 0</inertia></Body>
<Body name="b"><mass>1</mass><inertia>1 1 1 0 0 0</inertia></Body></objects></BodySet><JointSet><objects>
<FreeJoint name="ja"><socket_parent_frame>/ground</socket_parent_frame><socket_child_frame>/bodyset/a
</socket_child_frame></FreeJoint>
<FreeJoint name="jb"><socket_parent_frame>/ground</socket_parent_frame><socket_child_frame>/bodyset/b
</socket_child_frame></FreeJoint></objects></JointSet>
<ConstraintSet><objects>)" +
         constraints + "</objects></ConstraintSet></Model></OpenSimDocument>";
}
Model read_constrained(const std::string& constraints) {
  return OsimFile::parse(constrained_bodies(constraints), "m.osim").model();
}
std::string constraint_error(const std::string& constraints) {
  try {
    static_cast<void>(read_constrained(constraints));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(OsimConstraint, APointConstraintHoldsTwoPoints) {
  const Model model = read_constrained(
      "<PointConstraint name=\"p\"><socket_body_1>/bodyset/a</socket_body_1><socket_body_2>/bodyset/b</socket_body_2>"
      "<location_body_1>1 2 3</location_body_1><location_body_2>4 5 6</location_body_2></PointConstraint>");
  ASSERT_EQ(model.loops.size(), 1U);
  const LoopConstraint& c = model.loops[0];
  EXPECT_EQ(c.kind, LoopKind::kPoint);
  EXPECT_EQ(c.body_1, 1);
  EXPECT_EQ(c.body_2, 2);
  EXPECT_EQ(c.frame_1.translation, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(c.frame_2.translation, Eigen::Vector3d(4.0, 5.0, 6.0));
  EXPECT_TRUE(model.unsupported.empty());
}

TEST(OsimConstraint, AWeldConstraintHoldsTwoFrames) {
  const Model now = read_constrained(
      "<WeldConstraint name=\"w\"><socket_frame1>one</socket_frame1><socket_frame2>/bodyset/b</socket_frame2><frames>"
      "<PhysicalOffsetFrame name=\"one\"><socket_parent>/bodyset/a</socket_parent><translation>1 0 0</translation>"
      "<orientation>0.1 0.2 0.3</orientation></PhysicalOffsetFrame></frames></WeldConstraint>");
  // As the formats before 4.0 have it.
  const Model before = read_constrained(
      "<WeldConstraint name=\"w\"><isDisabled>false</isDisabled><body_1>a</body_1><body_2>b</body_2>"
      "<location_body_1>1 0 0</location_body_1><orientation_body_1>0.1 0.2 0.3</orientation_body_1></WeldConstraint>");
  for (const Model* model : {&now, &before}) {
    ASSERT_EQ(model->loops.size(), 1U);
    EXPECT_EQ(model->loops[0].kind, LoopKind::kWeld);
    EXPECT_EQ(model->loops[0].frame_1.translation, Eigen::Vector3d(1.0, 0.0, 0.0));
    EXPECT_TRUE(model->loops[0].frame_1.rotation.isApprox(body_fixed_xyz({0.1, 0.2, 0.3})));
  }
}

TEST(OsimConstraint, ADistanceAndAPointOnALine) {
  const Model model = read_constrained(
      "<ConstantDistanceConstraint name=\"d\"><socket_body_1>/ground</socket_body_1><socket_body_2>/bodyset/b"
      "</socket_body_2><constant_distance>0.3</constant_distance></ConstantDistanceConstraint>"
      "<PointOnLineConstraint name=\"l\"><socket_line_body>/ground</socket_line_body><socket_follower_body>/bodyset/a"
      "</socket_follower_body><line_direction_vec>0 0 2</line_direction_vec><point_on_line>1 0 0</point_on_line>"
      "</PointOnLineConstraint>");
  ASSERT_EQ(model.loops.size(), 2U);
  EXPECT_EQ(model.loops[0].kind, LoopKind::kDistance);
  EXPECT_EQ(model.loops[0].distance, 0.3);
  EXPECT_EQ(model.loops[1].kind, LoopKind::kPointOnLine);
  EXPECT_TRUE(model.loops[1].frame_1.rotation.col(0).isApprox(Eigen::Vector3d::UnitZ()));
  // Held there: 0.3 m from the ground's origin and on x = 1, y = 0.
  const MusculoskeletalSystem system(model);
  Eigen::VectorXd q = Eigen::VectorXd::Constant(12, 0.1);
  const Assembly closed = assemble(system, q, Eigen::VectorXd::Zero(12));
  EXPECT_NEAR(closed.q.segment(9, 3).norm(), 0.3, 1e-10);
  EXPECT_NEAR(closed.q(3), 1.0, 1e-10);
  EXPECT_NEAR(closed.q(4), 0.0, 1e-10);
}

TEST(OsimConstraint, WhatIsNotEnforcedOrNotUnderstoodIsSaid) {
  EXPECT_TRUE(
      read_constrained("<PointConstraint name=\"p\"><isEnforced>false</isEnforced></PointConstraint>").loops.empty());
  const Model model = read_constrained("<RollingOnSurfaceConstraint name=\"r\"/>");
  ASSERT_EQ(model.unsupported.size(), 1U);
  EXPECT_TRUE(model.unsupported[0].changes_motion);
}

TEST(OsimConstraint, MistakesAreNamed) {
  EXPECT_THAT(
      constraint_error("<PointConstraint name=\"p\"/>"),
      AllOf(HasSubstr("m.osim:"), HasSubstr("PointConstraint 'p'"), HasSubstr("body_1: names no body or frame")));
  EXPECT_THAT(constraint_error("<PointConstraint name=\"p\"><body_1>a</body_1><body_2>a</body_2></PointConstraint>"),
              HasSubstr("both ends are on the same body"));
  EXPECT_THAT(constraint_error("<ConstantDistanceConstraint name=\"d\"><body_1>a</body_1><body_2>b</body_2>"
                               "</ConstantDistanceConstraint>"),
              HasSubstr("constant_distance"));
  EXPECT_THAT(
      constraint_error("<PointOnLineConstraint name=\"l\"><line_body>a</line_body><follower_body>b</follower_body>"
                       "</PointOnLineConstraint>"),
      HasSubstr("line_direction_vec: has no direction"));
}

TEST(OsimConstraint, TheBouncingBlockOfOpenSimFallsAndBounces) {
  const std::filesystem::path file = veridyn::test::shared_folder() / "data/opensim/bouncing_block.osim";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  const MusculoskeletalSystem system(read_osim(file));
  EXPECT_FALSE(system.loops().empty());
  Progress progress;
  const MuscleTrajectory t = simulate_forward(system, default_start(system.model()),
                                              {ControlSignals(std::vector<double>(system.muscles().size(), 0.05)), {}},
                                              {.end = 0.5, .accuracy = 1e-6}, progress);
  EXPECT_TRUE(t.usable()) << t.message();
}

}  // namespace
}  // namespace veridyn::muscle
