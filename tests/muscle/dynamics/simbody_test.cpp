// Another program's multibody dynamics, in relative coordinates and by other recursions, as the judge of ours.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "tests/muscle/dynamics/loop_models.hpp"
#include "tests/support/simbody/simbody_description.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/dynamics/reduced_dynamics.hpp"
#include "veridyn/muscle/osim/joint_speeds.hpp"
#include "veridyn/muscle/simulation/assembly.hpp"

namespace veridyn::muscle {
namespace {

using numerics::RandomStream;

class Simbody : public testing::TestWithParam<int> {};

void compare(const Model& model, RandomStream& random) {
  const Mechanism mechanism(model);
  Dynamics<double> d(mechanism);
  test::SimbodyTree theirs(test::describe(model));
  for (int state = 0; state < 5; ++state) {
    const auto n = static_cast<std::size_t>(mechanism.coordinates());
    const Eigen::VectorXd q = test::random_state(n, 1.0, random), qdot = test::random_state(n, 3.0, random);
    const Eigen::VectorXd tau = test::random_state(n, 20.0, random), qddot = test::random_state(n, 10.0, random);
    d.set_state(q.data(), qdot.data());
    theirs.set_state(q, qdot);
    for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b) {
      const test::TreeDescription::Frame expected = theirs.body_pose(b);
      const Pose<double> pose = body_pose(mechanism, d.kinematics(), b);
      const SpatialVector<double>& V = d.kinematics().velocity[mechanism.body(b).link];
      const Eigen::Vector3d center = pose * model.bodies[b].mass_center;
      EXPECT_LT((pose.rotation - expected.rotation).norm(), 1e-12);
      EXPECT_LT((pose.position - expected.translation).norm(), 1e-12);
      EXPECT_LT((V.at(center) - theirs.mass_center_velocity(b)).norm(), 1e-11);
      EXPECT_LT((V.angular - theirs.angular_velocity(b)).norm(), 1e-11);
    }
    Eigen::MatrixXd M;
    d.mass_matrix(M);
    EXPECT_LT((M - theirs.mass_matrix()).norm(), 1e-12 * M.norm());
    Eigen::VectorXd ours(q.size());
    d.inverse_dynamics(qddot.data(), nullptr, ours.data());
    const Eigen::VectorXd expected_tau = theirs.inverse_dynamics(qddot);
    EXPECT_LT((ours - expected_tau).norm(), 1e-11 * expected_tau.norm());
    const Eigen::VectorXd expected = theirs.accelerations(tau);
    ASSERT_TRUE(d.forward_dynamics_factorized(tau.data(), nullptr, ours.data()).usable());
    EXPECT_LT((ours - expected).norm(), 1e-9 * expected.norm());
    ASSERT_TRUE(d.forward_dynamics_articulated(tau.data(), nullptr, ours.data()).usable());
    EXPECT_LT((ours - expected).norm(), 1e-9 * expected.norm());
  }
}

TEST_P(Simbody, AgreesOnRandomTrees) {
  RandomStream random(21, static_cast<std::uint64_t>(GetParam()));
  compare(test::random_tree(1 + GetParam() % 10, random), random);
}

INSTANTIATE_TEST_SUITE_P(Trees, Simbody, testing::Range(0, 60));

TEST(Simbody, AgreesOnEveryKindOfJoint) {
  RandomStream random(22, "kinds");
  for (int kind = 0; kind < test::kTreeJoints; ++kind) {
    SCOPED_TRACE(kind);
    Model model;
    model.gravity = {1.0, -9.0, 2.0};
    model.bodies.resize(1);
    for (int i = 0; i < 2; ++i) {
      const int child = test::add_body(model, random);
      test::add_joint(model, static_cast<test::TreeJoint>(kind), i, child, random);
    }
    compare(model, random);
  }
}

/// Poses, velocities and accelerations near the default pose, with loops closed where there are any. Returns how many
/// states were compared.
int compare_motion(const Model& model, RandomStream& random, double size) {
  const MusculoskeletalSystem system(model);
  const Mechanism& mechanism = system.mechanism();
  ReducedDynamics<double> ours(mechanism, system.reduction(), &system.loops());
  test::SimbodyTree theirs(test::describe(model));
  int compared = 0;
  for (int state = 0; state < 5; ++state) {
    const auto n = static_cast<std::size_t>(mechanism.coordinates());
    Assembly closed;
    try {
      closed = assemble(system, model.default_pose() + test::random_state(n, size, random),
                        test::random_state(n, 3.0, random));
    } catch (const InputError&) {
      continue;  // these random loops do not close
    }
    ++compared;
    const Eigen::VectorXd tau = test::random_state(n, 20.0, random);
    ours.set_state(closed.q.data(), closed.qdot.data(), nullptr);
    theirs.set_state(closed.q, closed.qdot);
    const Eigen::VectorXd speeds = theirs.speeds();
    EXPECT_LT((opensim_speeds(model, closed.q, closed.qdot) - speeds).norm(), 1e-12 * (1.0 + speeds.norm()));
    EXPECT_LT((rates_of_opensim_speeds(model, closed.q, speeds) - closed.qdot).norm(), 1e-10 * (1.0 + speeds.norm()));
    for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b) {
      const test::TreeDescription::Frame expected = theirs.body_pose(b);
      const Pose<double> pose = body_pose(mechanism, ours.kinematics(), b);
      const SpatialVector<double>& V = ours.kinematics().velocity[mechanism.body(b).link];
      EXPECT_LT((pose.rotation - expected.rotation).norm(), 1e-12) << b;
      EXPECT_LT((pose.position - expected.translation).norm(), 1e-12) << b;
      EXPECT_LT((V.at(pose * model.bodies[b].mass_center) - theirs.mass_center_velocity(b)).norm(), 1e-10) << b;
      EXPECT_LT((V.angular - theirs.angular_velocity(b)).norm(), 1e-10) << b;
    }
    Eigen::VectorXd accelerations(closed.q.size());
    EXPECT_TRUE(ours.forward_dynamics(tau.data(), nullptr, accelerations.data()).usable());
    const Eigen::VectorXd expected = theirs.accelerations(tau);
    EXPECT_LT((accelerations - expected).norm(), 1e-9 * expected.norm());
  }
  return compared;
}

/// A joint of a type of OpenSim's, with its axes.
Joint typed_joint(Model& model, const char* type, const std::vector<int>& axes, int parent, int child,
                  RandomStream& random) {
  Joint joint;
  joint.name = type;
  joint.type = type;
  joint.parent = parent;
  joint.child = child;
  joint.parent_frame = test::random_placement(random);
  joint.child_frame = test::random_placement(random);
  for (int i = 0; i < 3; ++i) joint.rotation[i].axis = joint.translation[i].axis = Eigen::Vector3d::Unit(i);
  for (const int a : axes) {
    TransformAxis& axis = a < 3 ? joint.rotation[a] : joint.translation[a - 3];
    axis.coordinate = static_cast<int>(model.coordinates.size());
    axis.function = numerics::PiecewisePolynomial::linear(1.0, 0.0);
    joint.coordinates.push_back(axis.coordinate);
    model.coordinates.push_back({.name = "q", .joint = static_cast<int>(model.joints.size())});
  }
  return joint;
}

// As OpenSim builds joints: of a ball, a free joint and an ellipsoid Simbody's speeds are angular velocities, its
// forces those on them.
TEST(Simbody, AgreesOnMobilizersOfTheirOwnTypeBothWaysRound) {
  const std::vector<std::pair<const char*, std::vector<int>>> kinds{
      {"UniversalJoint", {0, 1}}, {"BallJoint", {0, 1, 2}},          {"GimbalJoint", {0, 1, 2}},
      {"PlanarJoint", {2, 3, 4}}, {"FreeJoint", {0, 1, 2, 3, 4, 5}}, {"EllipsoidJoint", {0, 1, 2}}};
  RandomStream random(24, "types");
  for (const auto& [type, axes] : kinds) {
    for (const bool reversed : {false, true}) {
      SCOPED_TRACE(std::string(type) + (reversed ? " reversed" : ""));
      Model model;
      model.gravity = {1.0, -9.0, 2.0};
      model.bodies.resize(1);
      for (int i = 0; i < 2; ++i) {
        const int child = test::add_body(model, random);
        Joint joint = typed_joint(model, type, axes, i, child, random);
        joint.reversed = reversed;
        if (joint.type == "EllipsoidJoint") joint.ellipsoid_radii = {0.08, 0.2, 0.12};
        model.joints.push_back(std::move(joint));
      }
      EXPECT_EQ(compare_motion(model, random, 1.0), 5);
    }
  }
}

TEST(Simbody, AgreesOnReversedJointsOfFunctions) {
  RandomStream random(25, "reversed");
  for (int kind = 0; kind < test::kTreeJoints; ++kind) {
    SCOPED_TRACE(kind);
    Model model;
    model.gravity = {1.0, -9.0, 2.0};
    model.bodies.resize(1);
    for (int i = 0; i < 3; ++i) {
      const int child = test::add_body(model, random);
      test::add_joint(model, static_cast<test::TreeJoint>(kind), i, child, random).reversed = i != 1;
    }
    EXPECT_EQ(compare_motion(model, random, 1.0), 5);
  }
}

TEST(Simbody, AgreesOnClosedLoops) {
  RandomStream random(26, "loops");
  int compared = 0;
  for (int trial = 0; trial < 24; ++trial) {
    SCOPED_TRACE(trial);
    Model model = test::random_loops(random);
    // One loop of a kind, or two of different kinds.
    const LoopConstraint one = model.loops[trial % 4], two = model.loops[(trial + 1 + trial / 4 % 3) % 4];
    model.loops = {one};
    if (trial % 2 == 1) model.loops.push_back(two);
    compared += compare_motion(model, random, 0.3);
  }
  EXPECT_GE(compared, 110) << "of 120: a start may be too far away";
  EXPECT_GE(compare_motion(test::four_bar(), random, 0.5), 1);
}

TEST(Simbody, AgreesOnTheArmAndOnAWalkersTree) {
  RandomStream random(23, "bodies");
  compare(test::arm26_skeleton(), random);
  compare(test::gait_like(), random);
}

}  // namespace
}  // namespace veridyn::muscle
