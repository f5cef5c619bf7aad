// Forward dynamics with loops; that of couplers and drives is in coordinate_reduction_test.cpp.
#include "veridyn/muscle/dynamics/reduced_dynamics.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/muscle/dynamics/loop_models.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/simulation/assembly.hpp"

namespace veridyn::muscle {
namespace {

using numerics::RandomStream;

/// A coupler, a locked coordinate and loops at once, assembled near a pose at which they close; not where the locked
/// coordinate, moved, keeps them open.
TEST(ReducedDynamics, WithLoopsIsTheSolutionWithLagrangeMultipliers) {
  RandomStream random(81, "loops");
  int compared = 0;
  for (int trial = 0; trial < 30; ++trial) {
    Model model = test::random_loops(random);
    model.loops.erase(model.loops.begin() + trial % 4);
    model.loops.erase(model.loops.begin() + trial % 3);
    model.coordinates[4].locked = true;
    const Eigen::VectorXd q0 = model.default_pose();
    model.couplers.push_back({"couple", 7, 9, numerics::PiecewisePolynomial::linear(-0.7, q0(9) + 0.7 * q0(7))});
    const MusculoskeletalSystem system(model);
    const auto n = static_cast<Eigen::Index>(model.coordinates.size());
    Assembly start;
    try {
      start = assemble(system, q0 + 0.1 * test::random_state(system.coordinates(), 1.0, random),
                       test::random_state(system.coordinates(), 2.0, random));
    } catch (const InputError&) {
      continue;
    }
    ++compared;
    ReducedDynamics<double> reduced(system.mechanism(), system.reduction(), &system.loops());
    std::vector<double> z, zdot;
    for (const int c : system.reduction().free()) {
      z.push_back(start.q(c));
      zdot.push_back(start.qdot(c));
    }
    std::vector<DrivenMotion<double>> driven = system.reduction().default_motion();
    driven[0] = {start.q(4), 0.0, 1.5};
    reduced.set_state(z.data(), zdot.data(), driven.data());
    const Eigen::VectorXd tau = test::random_state(system.coordinates(), 10.0, random);
    std::vector<double> zddot(z.size());
    ASSERT_TRUE(reduced.forward_dynamics(tau.data(), nullptr, zddot.data()).usable());
    const Eigen::VectorXd qddot = reduced.qddot();

    Dynamics<double> d(system.mechanism());
    d.set_state(start.q.data(), start.qdot.data());
    Eigen::MatrixXd M;
    d.mass_matrix(M);
    Eigen::VectorXd h(n);
    d.inverse_dynamics(nullptr, nullptr, h.data());
    std::vector<LoopRow<double>> rows(static_cast<std::size_t>(system.loops().rows()));
    system.loops().evaluate(d.kinematics(), rows.data());
    const auto loops = static_cast<Eigen::Index>(rows.size()), all = loops + 2;
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(all, n);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(all);
    for (int r = 0; r < system.loops().rows(); ++r) {
      const LoopRow<double>& row = rows[r];
      const LoopConstraints::Constraint& c = system.loops().of_row(r);
      for (int k = 0; k < static_cast<int>(n); ++k) {
        const double part = d.kinematics().columns[k].dot(row.force);
        if (system.mechanism().moves(k, c.link_2)) A(r, k) += part;
        if (system.mechanism().moves(k, c.link_1)) A(r, k) -= part;
      }
      const SpatialVector<double>&A1 = d.acceleration(c.link_1), &A2 = d.acceleration(c.link_2);
      b(r) = -(row.rate_bias + row.force.dot({A2.angular - A1.angular, A2.linear - A1.linear}));
      EXPECT_NEAR(row.error, 0.0, 1e-9);
      EXPECT_NEAR(row.rate, 0.0, 1e-9);
    }
    A(loops, 9) = 1.0;
    A(loops, 7) = 0.7;
    A(loops + 1, 4) = 1.0;
    b(loops + 1) = 1.5;
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n + all, n + all);
    K.topLeftCorner(n, n) = M;
    K.topRightCorner(n, all) = -A.transpose();
    K.bottomLeftCorner(all, n) = A;
    Eigen::VectorXd right(n + all);
    right << tau - h, b;
    const Eigen::VectorXd solution = K.fullPivLu().solve(right);
    // Errors of the assembly, up to 1e-13, come back 400 times larger.
    EXPECT_LT((solution.head(n) - qddot).norm(), 1e-9 * qddot.norm()) << "trial " << trial;
    // Inverse dynamics of these accelerations is what drives, couples and holds them.
    Eigen::VectorXd needed(n);
    d.inverse_dynamics(qddot.data(), nullptr, needed.data());
    Eigen::VectorXd given = tau;
    reduced.loops()->add_generalized_forces(reduced.kinematics(), given.data());
    for (Eigen::Index c = 0; c < n; ++c) {
      if (c == 4 || c == 7 || c == 9) continue;
      EXPECT_NEAR(needed(c), given(c), 1e-8 * needed.norm()) << c;
    }
    EXPECT_NEAR(needed(7) - 0.7 * needed(9), given(7) - 0.7 * given(9), 1e-8 * needed.norm());
  }
  EXPECT_GE(compared, 20);
}

TEST(ReducedDynamics, RepeatedLoopsChangeNothing) {
  // The same hinge twice, and once more as a weld of what cannot turn out of the plane.
  const Model once = test::four_bar();
  Model again = once;
  again.loops.push_back(once.loops[0]);
  again.loops.push_back(once.loops[0]);
  again.loops.back().kind = LoopKind::kDistance;
  again.loops.back().body_1 = 0;
  again.loops.back().body_2 = 1;
  again.loops.back().frame_1.translation = {0.0, 0.0, 0.0};
  again.loops.back().frame_2.translation = {0.0, -0.3, 0.0};
  again.loops.back().distance = 0.3;
  const MusculoskeletalSystem one(once), two(again);
  const Eigen::Vector3d near(0.5, 1.0, 0.2), speeds(1.0, 0.0, 0.0), tau(1.0, -2.0, 0.5);
  const Assembly start = assemble(one, near, speeds);
  ASSERT_GT(start.qdot.norm(), 0.1);
  Eigen::Vector3d a, b;
  ReducedDynamics<double> first(one.mechanism(), one.reduction(), &one.loops());
  ReducedDynamics<double> second(two.mechanism(), two.reduction(), &two.loops());
  first.set_state(start.q.data(), start.qdot.data(), nullptr);
  second.set_state(start.q.data(), start.qdot.data(), nullptr);
  ASSERT_TRUE(first.forward_dynamics(tau.data(), nullptr, a.data()).usable());
  ASSERT_TRUE(second.forward_dynamics(tau.data(), nullptr, b.data()).usable());
  EXPECT_LT((a - b).norm(), 1e-9 * a.norm());
}

}  // namespace
}  // namespace veridyn::muscle
