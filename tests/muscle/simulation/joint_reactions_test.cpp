#include "veridyn/muscle/simulation/joint_reactions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

/// The built-in arm at rest, at one instant.
struct RestingArm {
  MusculoskeletalSystem system{load_model("arm").model()};
  std::vector<double> time{0.0};
  estimation::RowMatrix q{{0.0, 90.0 * kDegree}};
  estimation::RowMatrix zero = estimation::RowMatrix::Zero(1, 2);
  estimation::RowMatrix none;

  [[nodiscard]] JointReactions reactions(ReactionFrame frame, const estimation::RowMatrix& tendon_force = {},
                                         const ExternalLoads* external = nullptr) const {
    return joint_reactions(system,
                           {.time = time,
                            .q = q,
                            .qdot = zero,
                            .qddot = zero,
                            .tendon_force = tendon_force,
                            .reserve = none,
                            .external = external},
                           frame);
  }
};

TEST(JointReactions, OfRestCarryTheWeight) {
  const RestingArm arm;
  const JointReactions r = arm.reactions(ReactionFrame::kGround);
  ASSERT_EQ(r.joints.size(), 2u);
  // The forearm of 1.5 kg is level with its mass centre 0.17 m before the elbow; the humerus of 1.9 kg hangs.
  EXPECT_NEAR(r.force(0, 4), 1.5 * kGravity, 1e-12);
  EXPECT_NEAR(r.moment(0, 5), 1.5 * 0.17 * kGravity, 1e-12);
  EXPECT_NEAR(r.force(0, 1), 3.4 * kGravity, 1e-12);
  EXPECT_NEAR(r.moment(0, 2), 1.5 * 0.17 * kGravity, 1e-12);
}

TEST(JointReactions, AreExpressedInTheFrameAskedFor) {
  const RestingArm arm;
  // The forearm's y axis points back along it: level, turned by 90 deg about z, "up" is its -x... +x turns to up.
  const JointReactions r = arm.reactions(ReactionFrame::kChild);
  EXPECT_NEAR(r.force(0, 3), 1.5 * kGravity, 1e-12);
  EXPECT_NEAR(r.force(0, 4), 0.0, 1e-12);
  EXPECT_NEAR(arm.reactions(ReactionFrame::kParent).force(0, 4), 1.5 * kGravity, 1e-12);
}

TEST(JointReactions, MusclesPressTheJointTogether) {
  const RestingArm arm;
  const JointReactions without = arm.reactions(ReactionFrame::kGround);
  const Model& model = arm.system.model();
  Kinematics<double> kinematics(arm.system.mechanism());
  const Eigen::VectorXd q = arm.q.row(0);
  update_positions(arm.system.mechanism(), q.data(), kinematics);
  PathWorkspace<double> paths(arm.system.paths());
  arm.system.paths().evaluate(kinematics, q.data(), paths);
  for (std::size_t m = 0; m < model.muscles.size(); ++m) {
    SCOPED_TRACE(model.muscles[m].name());
    estimation::RowMatrix tension = estimation::RowMatrix::Zero(1, model.muscles.size());
    tension(0, m) = 100.0;
    const JointReactions with = arm.reactions(ReactionFrame::kGround, tension);
    // It pulls the forearm along the last piece of its path; the joint holds against that.
    const std::vector<Eigen::Vector3d> line = arm.system.paths().polyline(kinematics, q.data(), static_cast<int>(m));
    const Eigen::Vector3d pull = 100.0 * (line[line.size() - 2] - line.back()).normalized();
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(with.force(0, 3 + axis) - without.force(0, 3 + axis), -pull(axis), 1e-9);
    // About each joint's axis (z) what it no longer has to hold is tension times moment arm.
    for (std::size_t k = arm.system.paths().first_pair(static_cast<int>(m));
         k < arm.system.paths().end_pair(static_cast<int>(m)); ++k) {
      const Eigen::Index column = 3 * arm.system.paths().pairs()[k].coordinate + 2;
      EXPECT_NEAR(with.moment(0, column) - without.moment(0, column), 100.0 * paths.gradient[k], 1e-9);
    }
  }
}

TEST(JointReactions, OfWeldsAreWhatBodiesBeyondThemNeed) {
  // The built-in arm with a hand of 0.4 kg welded to its forearm, which raises and turns.
  std::string text(builtin_models()[0].text);
  const auto insert = [&text](const std::string& set, const std::string& what) {
    const std::size_t objects = text.find("<objects>", text.find(set));
    ASSERT_NE(objects, std::string::npos);
    text.insert(objects + 9, what);
  };
  insert(
      "<BodySet",
      "<Body name=\"hand\"><mass>0.4</mass><mass_center>0.01 -0.05 0.02</mass_center><inertia>0.001 0.0002 0.001 0 0 "
      "0</inertia></Body>");
  insert("<JointSet",
         "<WeldJoint name=\"wrist\"><socket_parent_frame>wrist_in_forearm</socket_parent_frame>"
         "<socket_child_frame>/bodyset/hand</socket_child_frame><frames><PhysicalOffsetFrame "
         "name=\"wrist_in_forearm\"><socket_parent>/bodyset/forearm</socket_parent><translation>0.02 -0.25 0.01"
         "</translation><orientation>0.3 -0.2 0.1</orientation></PhysicalOffsetFrame></frames></WeldJoint>");
  const MusculoskeletalSystem system(OsimFile::parse(text, "arm.osim").model());
  const Model& model = system.model();
  const std::vector<double> time{0.0};
  const estimation::RowMatrix q{{0.4, 1.1}}, qdot{{1.5, -2.0}}, qddot{{3.0, 5.0}}, none;
  const JointReactions r = joint_reactions(
      system, {.time = time, .q = q, .qdot = qdot, .qddot = qddot, .tendon_force = none, .reserve = none},
      ReactionFrame::kGround);
  ASSERT_EQ(r.joints.size(), 3U);
  const auto wrist =
      std::find_if(r.joints.begin(), r.joints.end(), [&](int j) { return model.joints[j].name == "wrist"; }) -
      r.joints.begin();
  // Newton and Euler for the hand alone, accelerations by differences along the motion.
  const auto hand_at = [&](double t) {
    const Eigen::VectorXd pose = q.row(0) + t * qdot.row(0) + 0.5 * t * t * qddot.row(0);
    Kinematics<double> kinematics(system.mechanism());
    update_positions(system.mechanism(), pose.data(), kinematics);
    return body_pose(system.mechanism(), kinematics, model.body("hand"));
  };
  const Body& hand = model.bodies[model.body("hand")];
  const double h = 1e-4;
  const Pose<double> now = hand_at(0.0);
  const Eigen::Vector3d center = now * hand.mass_center;
  const Eigen::Vector3d acceleration =
      (hand_at(h) * hand.mass_center + hand_at(-h) * hand.mass_center - 2.0 * center) / (h * h);
  const Eigen::Vector3d force = hand.mass * (acceleration - model.gravity);
  const auto momentum = [&](double t) {
    const Eigen::Matrix3d R = hand_at(t).rotation;
    const Eigen::Matrix3d spin = (hand_at(t + h).rotation - hand_at(t - h).rotation) / (2.0 * h) * R.transpose();
    return Eigen::Vector3d(R * hand.inertia * R.transpose() * Eigen::Vector3d(spin(2, 1), spin(0, 2), spin(1, 0)));
  };
  const Eigen::Vector3d moment = (momentum(h) - momentum(-h)) / (2.0 * h) + (center - now.position).cross(force);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(r.force(0, 3 * wrist + i), force(i), 1e-6);
    EXPECT_NEAR(r.moment(0, 3 * wrist + i), moment(i), 1e-6);
  }
}

TEST(JointReactions, ExternalLoadsActWhereTheyDo) {
  const RestingArm arm;
  ExternalLoadSource source{.name = "push", .place = "s", .body = "forearm"};
  source.constant_force = {0.0, 20.0, 0.0};
  source.constant_point = {0.0, -0.25, 0.0};
  source.point_frame = "forearm";
  source.has_constant_point = true;
  ExternalLoads loads;
  add_external_loads({&source, 1}, nullptr, arm.system.model(), 0.0, loads);
  const JointReactions r = arm.reactions(ReactionFrame::kGround, {}, &loads);
  EXPECT_NEAR(r.force(0, 4), 1.5 * kGravity - 20.0, 1e-12);
  EXPECT_NEAR(r.moment(0, 5), 1.5 * 0.17 * kGravity - 0.25 * 20.0, 1e-12);
}

}  // namespace
}  // namespace veridyn::muscle
