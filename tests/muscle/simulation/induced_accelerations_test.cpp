#include "veridyn/muscle/simulation/induced_accelerations.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "tests/muscle/dynamics/loop_models.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/simulation/assembly.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"

namespace veridyn::muscle {
namespace {

const estimation::RowMatrix kNoTable;

TEST(InducedAccelerations, OfTheArmAddUpAndAreTheForcesMomentsOverItsInertia) {
  const MusculoskeletalSystem system(load_model("arm").model());
  const std::vector<double> time{0.0};
  const estimation::RowMatrix q{{0.3, 1.2}}, qdot{{1.0, -2.0}}, reserve{{2.0, -1.0}};
  estimation::RowMatrix tension(1, 6);
  tension << 100.0, 50.0, 20.0, 80.0, 10.0, 60.0;
  const InducedAccelerations induced = induced_accelerations(
      system, {.time = time, .q = q, .qdot = qdot, .qddot = kNoTable, .tendon_force = tension, .reserve = reserve});
  ASSERT_EQ(induced.coordinates.size(), 2U);
  ASSERT_EQ(induced.sources.size(), 10U);
  // All forces at once.
  SystemEvaluator<double> evaluator(system);
  const Eigen::Vector2d z = q.row(0), zdot = qdot.row(0);
  evaluator.set_motion(z.data(), zdot.data());
  Eigen::Vector2d tau = reserve.row(0);
  for (std::size_t k = 0; k < system.pairs().size(); ++k)
    tau(system.pairs()[k].coordinate) -= tension(0, system.pairs()[k].muscle) * evaluator.path_gradient()[k];
  evaluator.add_passive_forces(tau.data());
  Eigen::Vector2d all;
  ASSERT_TRUE(evaluator.dynamics().forward_dynamics(tau.data(), nullptr, all.data()).usable());
  for (std::size_t c = 0; c < 2; ++c) EXPECT_NEAR(induced.part[c].row(0).sum(), all(c), 1e-11 * all.norm());
  // The moments of one muscle over the mass matrix.
  Eigen::MatrixXd M;
  evaluator.dynamics().dynamics().mass_matrix(M);
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < system.pairs().size(); ++k)
    if (system.pairs()[k].muscle == 3) moment(system.pairs()[k].coordinate) -= 80.0 * evaluator.path_gradient()[k];
  const Eigen::Vector2d expected = M.inverse() * moment;
  EXPECT_GT(expected.norm(), 1.0);
  for (std::size_t c = 0; c < 2; ++c) EXPECT_NEAR(induced.part[c](0, 3), expected(c), 1e-11 * expected.norm());
}

TEST(InducedAccelerations, OfAPendulumAreGravitysAndNoVelocitys) {
  Model model = test::pendulum(1);
  model.coordinates[0].low = -10.0;
  model.coordinates[0].high = 10.0;
  const MusculoskeletalSystem system(model);
  const std::vector<double> time{0.0};
  const estimation::RowMatrix q{{0.8}}, qdot{{3.0}};
  const InducedAccelerations induced = induced_accelerations(
      system, {.time = time, .q = q, .qdot = qdot, .qddot = kNoTable, .tendon_force = kNoTable, .reserve = kNoTable});
  // A rod of 1 kg, its centre at 0.25 m, 0.02 kg m^2 about it.
  const double g = -model.gravity.y(), inertia = 0.02 + 0.25 * 0.25;
  ASSERT_EQ(induced.sources, (std::vector<std::string>{"gravity", "velocity", "passive"}));
  EXPECT_NEAR(induced.part[0](0, 0), -g * 0.25 * std::sin(0.8) / inertia, 1e-12);
  EXPECT_NEAR(induced.part[0](0, 1), 0.0, 1e-12);
  EXPECT_EQ(induced.part[0](0, 2), 0.0);
}

TEST(InducedAccelerations, GoThroughClosedLoops) {
  const MusculoskeletalSystem system(test::four_bar());
  const Assembly start = assemble(system, Eigen::Vector3d(0.5, 1.0, 0.2), Eigen::Vector3d(2.0, 0.0, 0.0));
  const std::vector<double> time{0.0};
  const estimation::RowMatrix q = start.q.transpose(), qdot = start.qdot.transpose();
  const estimation::RowMatrix reserve{{0.0, 0.0, 5.0}};
  const InducedAccelerations induced = induced_accelerations(
      system, {.time = time, .q = q, .qdot = qdot, .qddot = kNoTable, .tendon_force = kNoTable, .reserve = reserve});
  // A moment on the rocker turns the crank, in the ratio of the linkage's speeds.
  const auto reserves = static_cast<Eigen::Index>(induced.sources.size() - 1);
  const double crank = induced.part[0](0, reserves), rocker = induced.part[2](0, reserves);
  EXPECT_GT(std::abs(crank), 1.0);
  EXPECT_NEAR(crank / rocker, start.qdot(0) / start.qdot(2), 1e-9);
}

}  // namespace
}  // namespace veridyn::muscle
