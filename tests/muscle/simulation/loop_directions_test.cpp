#include "veridyn/muscle/simulation/loop_directions.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/muscle/dynamics/loop_models.hpp"
#include "veridyn/muscle/simulation/assembly.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"

namespace veridyn::muscle {
namespace {

// Accelerations along which four bars stay closed: a step of the motion with them opens the loop in third order only.
TEST(LoopDirections, KeepFourBarsClosed) {
  const MusculoskeletalSystem system(test::four_bar());
  const Assembly start = assemble(system, Eigen::Vector3d(0.5, 0.3, 0.4), Eigen::Vector3d(2.0, -1.0, 0.5));
  SystemEvaluator<double> evaluator(system);
  evaluator.set_pose(start.q.data(), start.qdot.data());
  LoopDirections directions(system);
  ASSERT_TRUE(directions.any());
  LoopSolver<double>& loops = directions.set_pose(evaluator.dynamics());
  ASSERT_EQ(directions.directions().cols(), 1);
  EXPECT_NEAR(directions.directions().col(0).norm(), 1.0, 1e-14);
  EXPECT_LT((directions.jacobian() * directions.directions()).norm(), 1e-14);
  Eigen::VectorXd qddot = Eigen::Vector3d(3.0, 1.0, -2.0);
  std::vector<double> tau(3);
  evaluator.dynamics().dynamics().inverse_dynamics(qddot.data(), nullptr, tau.data());
  const Eigen::VectorXd change = directions.acceleration_shortfall(evaluator.dynamics());
  EXPECT_GT(change.norm(), 0.1);
  // The least change: none of it along the motion allowed.
  EXPECT_NEAR(directions.directions().col(0).dot(change), 0.0, 1e-12);
  qddot += change;
  const auto open = [&](double h) {
    const Eigen::VectorXd q = start.q + h * start.qdot + 0.5 * h * h * qddot;
    evaluator.set_pose(q.data(), start.qdot.data());
    const LoopSolver<double>& then = evaluator.dynamics().update_loops();
    double error = 0.0;
    for (int r = 0; r < then.rows(); ++r) error = std::max(error, std::abs(then.row(r).error));
    return error;
  };
  EXPECT_NEAR(open(2e-3) / open(1e-3), 8.0, 0.1);
  // What the loops carry of forces leaves those along the motion.
  evaluator.set_pose(start.q.data(), start.qdot.data());
  const Eigen::VectorXd forces = Eigen::Vector3d(1.0, -4.0, 2.0);
  directions.set_pose(evaluator.dynamics());
  directions.carry(forces, loops);
  Eigen::VectorXd left = forces;
  for (int r = 0; r < loops.rows(); ++r) left -= loops.multiplier(r) * directions.jacobian().row(r).transpose();
  const Eigen::VectorXd along = directions.directions() * (directions.directions().transpose() * forces);
  EXPECT_LT((left - along).norm(), 1e-12);
}

}  // namespace
}  // namespace veridyn::muscle
