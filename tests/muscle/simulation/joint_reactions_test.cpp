#include "veridyn/muscle/simulation/joint_reactions.hpp"

#include <gtest/gtest.h>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

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
