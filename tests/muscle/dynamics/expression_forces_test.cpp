#include "veridyn/muscle/dynamics/expression_forces.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include "tests/muscle/dynamics/model_trees.hpp"

namespace veridyn::muscle {
namespace {

using numerics::RandomStream;

/// Two bodies on free joints.
Model two_free(RandomStream& random) {
  Model model;
  model.bodies.resize(1);
  for (int i = 0; i < 2; ++i) {
    const int child = test::add_body(model, random);
    test::add_joint(model, test::TreeJoint::kFree, 0, child, random);
  }
  return model;
}

TEST(ExpressionForces, OfALinearFormulaAreThoseOfTheSpringAndOfTheBushing) {
  RandomStream random(91, "formulas");
  const Model model = two_free(random);
  const Mechanism mechanism(model);
  BodyForces springs;
  springs.springs.push_back({.name = "s",
                             .body_1 = 1,
                             .body_2 = 2,
                             .point_1 = {0.1, 0.2, 0.3},
                             .point_2 = {-0.1, 0.0, 0.2},
                             .stiffness = 200.0,
                             .rest_length = 0.3});
  Bushing bushing;
  bushing.body_1 = 2;
  bushing.body_2 = 1;
  bushing.frame_1 = test::random_placement(random);
  bushing.frame_2 = test::random_placement(random);
  bushing.rotational_damping = {0.1, 0.2, 0.3};
  bushing.translational_damping = {3.0, 2.0, 1.0};
  ExpressionForces formulas;
  formulas.points.push_back({.name = "s",
                             .body_1 = 1,
                             .body_2 = 2,
                             .point_1 = {0.1, 0.2, 0.3},
                             .point_2 = {-0.1, 0.0, 0.2},
                             .force = Expression("200*(d-0.3)", {"d", "ddot"})});
  ExpressionBushing by_formula{bushing, {}};
  for (const char* text : {"5*theta_x", "6*theta_y", "7*theta_z", "80*delta_x", "90*delta_y", "100*delta_z"})
    by_formula.resistance.emplace_back(
        text, std::vector<std::string>{"theta_x", "theta_y", "theta_z", "delta_x", "delta_y", "delta_z"});
  formulas.bushings.push_back(std::move(by_formula));
  bushing.set_stiffness({5.0, 6.0, 7.0}, {80.0, 90.0, 100.0});
  springs.bushings.push_back(bushing);
  Kinematics<double> kinematics(mechanism);
  for (int trial = 0; trial < 10; ++trial) {
    const Eigen::VectorXd q = test::random_state(12, 0.6, random), qdot = test::random_state(12, 2.0, random);
    update_positions(mechanism, q.data(), kinematics);
    update_velocities(mechanism, qdot.data(), kinematics);
    Eigen::VectorXd a = Eigen::VectorXd::Zero(12), b = a;
    add_body_forces(springs, mechanism, kinematics, a.data());
    add_body_expressions(formulas, mechanism, kinematics, b.data());
    EXPECT_GT(a.norm(), 1.0);
    EXPECT_LT((a - b).norm(), 1e-12 * a.norm());
  }
}

TEST(ExpressionForces, ADamperBetweenPointsTakesItsPowerFromTheMotion) {
  RandomStream random(92, "damper");
  const Model model = two_free(random);
  const Mechanism mechanism(model);
  ExpressionForces formulas;
  formulas.points.push_back({.name = "d", .body_1 = 1, .body_2 = 2, .force = Expression("3*ddot", {"d", "ddot"})});
  Kinematics<double> kinematics(mechanism);
  const Eigen::VectorXd q = test::random_state(12, 0.6, random), qdot = test::random_state(12, 2.0, random);
  update_positions(mechanism, q.data(), kinematics);
  update_velocities(mechanism, qdot.data(), kinematics);
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(12);
  add_body_expressions(formulas, mechanism, kinematics, tau.data());
  const auto distance = [&](double t) {
    const Eigen::VectorXd at = q + t * qdot;
    update_positions(mechanism, at.data(), kinematics);
    return (body_pose(mechanism, kinematics, 2).position - body_pose(mechanism, kinematics, 1).position).norm();
  };
  const double rate = (distance(1e-5) - distance(-1e-5)) / 2e-5;
  EXPECT_NEAR(tau.dot(qdot), -3.0 * rate * rate, 1e-7 * rate * rate);
}

TEST(ExpressionForces, DualNumbersCarryTheSlopesOfTheFormula) {
  using Jet = ceres::Jet<double, 2>;
  const Expression f("exp(-2*q)*sin(q*qdot)+step(q)*q^3", {"q", "qdot"});
  const double q = 0.7, v = -1.3;
  const Jet y = evaluate(f, std::array{Jet(q, 0), Jet(v, 1)});
  EXPECT_DOUBLE_EQ(y.a, std::exp(-2.0 * q) * std::sin(q * v) + q * q * q);
  EXPECT_NEAR(y.v[0], std::exp(-2.0 * q) * (v * std::cos(q * v) - 2.0 * std::sin(q * v)) + 3.0 * q * q, 1e-8);
  EXPECT_NEAR(y.v[1], std::exp(-2.0 * q) * q * std::cos(q * v), 1e-8);
}

}  // namespace
}  // namespace veridyn::muscle
