// Equations of constraints that close loops.
#include "veridyn/muscle/dynamics/loop_constraints.hpp"

#include <ceres/jet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/muscle/dynamics/loop_models.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/dynamics/dynamics.hpp"

namespace veridyn::muscle {
namespace {

using numerics::RandomStream;

TEST(LoopConstraints, ForcesAreTheirRatesAndBiasesTheRatesOfThose) {
  // A jet along the motion gives d/dt of all of it.
  using Jet = ceres::Jet<double, 1>;
  RandomStream random(71, "rows");
  for (int trial = 0; trial < 20; ++trial) {
    const Model model = test::random_loops(random);
    const Mechanism mechanism(model);
    const LoopConstraints loops(model, mechanism);
    const auto n = static_cast<std::size_t>(mechanism.coordinates());
    const Eigen::VectorXd q = test::random_state(n, 1.0, random), qdot = test::random_state(n, 2.0, random),
                          qddot = test::random_state(n, 3.0, random);
    std::vector<Jet> q_jets, qdot_jets;
    for (const double x : q) q_jets.emplace_back(x);
    for (const double x : qdot) qdot_jets.emplace_back(x);
    for (std::size_t c = 0; c < n; ++c) {
      q_jets[c].v[0] = qdot(static_cast<Eigen::Index>(c));
      qdot_jets[c].v[0] = qddot(static_cast<Eigen::Index>(c));
    }
    Kinematics<Jet> kinematics(mechanism);
    update_positions(mechanism, q_jets.data(), kinematics);
    update_velocities(mechanism, qdot_jets.data(), kinematics);
    std::vector<LoopRow<Jet>> rows(static_cast<std::size_t>(loops.rows()));
    loops.evaluate(kinematics, rows.data());
    Dynamics<double> dynamics(mechanism);
    dynamics.set_state(q.data(), qdot.data());
    Eigen::VectorXd tau(q.size());
    dynamics.inverse_dynamics(qddot.data(), nullptr, tau.data());
    std::vector<LoopRow<double>> values(rows.size());
    loops.evaluate(dynamics.kinematics(), values.data());
    for (int r = 0; r < loops.rows(); ++r) {
      const LoopRow<Jet>& row = rows[r];
      const LoopRow<double>& value = values[r];
      const LoopConstraints::Constraint& c = loops.of_row(r);
      EXPECT_NEAR(row.error.v[0], value.rate, 1e-12) << c.text;
      const SpatialVector<double>&A1 = dynamics.acceleration(c.link_1), &A2 = dynamics.acceleration(c.link_2);
      const double acceleration = value.rate_bias + value.force.dot({A2.angular - A1.angular, A2.linear - A1.linear});
      EXPECT_NEAR(row.rate.v[0], acceleration, 1e-11) << c.text;
    }
  }
}

TEST(LoopConstraints, WhatCannotHoldIsNamed) {
  Model model = test::four_bar();
  model.loops.push_back({.name = "no length", .kind = LoopKind::kDistance, .body_1 = 0, .body_2 = 2, .distance = 0.0});
  const auto refusal = [&] {
    try {
      const LoopConstraints loops(model, Mechanism(model));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(refusal(), testing::HasSubstr("ConstantDistanceConstraint 'no length'"));
  // Bodies that cannot move against each other.
  model.loops.back() = {.name = "same", .kind = LoopKind::kPoint, .body_1 = 2, .body_2 = 2};
  EXPECT_EQ(LoopConstraints(model, Mechanism(model)).rows(), 3) << "of the hinge";
  model.loops.back().frame_1.translation = {0.0, 0.1, 0.0};
  EXPECT_THAT(refusal(), testing::HasSubstr("PointConstraint 'same': its bodies are welded to each other 0.1 away"));
}

}  // namespace
}  // namespace veridyn::muscle
