// Rows of closed loops over the free coordinates, and the multipliers that meet them.
#include "veridyn/muscle/dynamics/loop_solver.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/muscle/dynamics/loop_models.hpp"
#include "veridyn/muscle/dynamics/reduced_dynamics.hpp"

namespace veridyn::muscle {
namespace {

/// The loops of the four-bar linkage at a pose.
struct PosedLinkage {
  PosedLinkage() { pose({0.3, 0.4, -0.2}); }
  void pose(const Eigen::Vector3d& q) {
    const Eigen::Vector3d still = Eigen::Vector3d::Zero();
    dynamics.set_state(q.data(), still.data(), nullptr);
    solver = &dynamics.update_loops();
  }
  Model model = test::four_bar();
  Mechanism mechanism{model};
  LoopConstraints loops{model, mechanism};
  CoordinateReduction reduction{model};
  ReducedDynamics<double> dynamics{mechanism, reduction, &loops};
  LoopSolver<double>* solver = nullptr;
};

TEST(LoopSolver, RowsAreTheSlopesOfTheErrors) {
  PosedLinkage linkage;
  const Eigen::Vector3d q(0.3, 0.4, -0.2);
  ASSERT_EQ(linkage.solver->rows(), 3);
  Eigen::Matrix3d rows;
  for (int r = 0; r < 3; ++r) rows.row(r) = Eigen::Map<const Eigen::RowVector3d>(linkage.solver->jacobian(r));
  const double h = 1e-6;
  for (int c = 0; c < 3; ++c) {
    Eigen::Vector3d error[2];
    for (int side = 0; side < 2; ++side) {
      linkage.pose(q + (side == 0 ? h : -h) * Eigen::Vector3d::Unit(c));
      for (int r = 0; r < 3; ++r) error[side](r) = linkage.solver->row(r).error;
    }
    for (int r = 0; r < 3; ++r) EXPECT_NEAR(rows(r, c), (error[0](r) - error[1](r)) / (2.0 * h), 1e-9);
  }
}

TEST(LoopSolver, MultipliersMeetWhatIsWantedAndThoseOfIdleRowsAreZero) {
  PosedLinkage linkage;
  LoopSolver<double>& solver = *linkage.solver;
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> A;
  for (int r = 0; r < 3; ++r) A.row(r) = Eigen::Map<const Eigen::RowVector3d>(solver.jacobian(r));
  // Nothing moves the linkage out of its plane.
  EXPECT_EQ(A.row(2).norm(), 0.0);
  const Eigen::Vector3d wanted = A * Eigen::Vector3d(0.7, -0.4, 0.9);
  solver.solve(A.data(), wanted.data());
  EXPECT_EQ(solver.multiplier(2), 0.0);
  const Eigen::Vector3d lambda(solver.multiplier(0), solver.multiplier(1), solver.multiplier(2));
  EXPECT_LT((A * (A.transpose() * lambda) - wanted).norm(), 1e-14);
  // Of two rows that are the same, one counts.
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> moved = A;
  moved.row(1) = A.row(0);
  const double first = A.row(0).squaredNorm(), cross = A.row(1).dot(A.row(0));
  EXPECT_GT(std::abs(cross), 1e-6);
  const Eigen::Vector3d same(first, cross, 0.0);
  solver.solve(moved.data(), same.data());
  EXPECT_NEAR(solver.multiplier(0) + solver.multiplier(1), 1.0, 1e-12);
}

TEST(LoopSolver, GeneralizedForcesAreTheRowsTimesTheirMultipliers) {
  PosedLinkage linkage;
  LoopSolver<double>& solver = *linkage.solver;
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> A;
  for (int r = 0; r < 3; ++r) A.row(r) = Eigen::Map<const Eigen::RowVector3d>(solver.jacobian(r));
  const Eigen::Vector3d wanted(0.2, -0.5, 0.0);
  solver.solve(A.data(), wanted.data());
  Eigen::Vector3d tau = Eigen::Vector3d::Zero();
  solver.add_generalized_forces(linkage.dynamics.kinematics(), tau.data());
  const Eigen::Vector3d lambda(solver.multiplier(0), solver.multiplier(1), solver.multiplier(2));
  EXPECT_LT((tau - A.transpose() * lambda).norm(), 1e-14);
  // By link: the same power in any motion.
  std::vector<SpatialVector<double>> by_link(static_cast<std::size_t>(linkage.mechanism.links()));
  for (int r = 0; r < solver.rows(); ++r) {
    const LoopConstraints::Constraint& constraint = solver.loops().of_row(r);
    by_link[static_cast<std::size_t>(constraint.link_2)].add_scaled(solver.multiplier(r), solver.row(r).force);
    by_link[static_cast<std::size_t>(constraint.link_1)].add_scaled(-solver.multiplier(r), solver.row(r).force);
  }
  Eigen::Vector3d from_links = Eigen::Vector3d::Zero();
  for (int link = 1; link < linkage.mechanism.links(); ++link)
    for (const int c : linkage.mechanism.ancestors(link))
      from_links(c) += linkage.dynamics.kinematics().columns[static_cast<std::size_t>(c)].dot(
          by_link[static_cast<std::size_t>(link)]);
  EXPECT_LT((tau - from_links).norm(), 1e-14);
}

}  // namespace
}  // namespace veridyn::muscle
