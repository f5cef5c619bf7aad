// Another program's multibody dynamics, in relative coordinates and by other recursions, as the judge of ours.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "tests/muscle/dynamics/model_trees.hpp"
#include "tests/support/simbody/simbody_description.hpp"
#include "veridyn/muscle/dynamics/dynamics.hpp"

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

TEST(Simbody, AgreesOnTheArmAndOnAWalkersTree) {
  RandomStream random(23, "bodies");
  compare(test::arm26_skeleton(), random);
  compare(test::gait_like(), random);
}

}  // namespace
}  // namespace veridyn::muscle
