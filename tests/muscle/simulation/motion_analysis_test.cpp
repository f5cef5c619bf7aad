#include "veridyn/muscle/simulation/motion_analysis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/muscle/minimum_jerk.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"
#include "veridyn/muscle/simulation/assembly.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"

namespace veridyn::muscle {
namespace {

TEST(MotionAnalysis, MomentsAreProducedByTheMuscles) {
  const MusculoskeletalSystem system(load_model("arm").model());
  const Motion motion = test::minimum_jerk(system.model(), 0.3, 1.6);
  Progress progress;
  for (const StaticForce force : {StaticForce::kAsOpenSim, StaticForce::kWithPassive, StaticForce::kIsometric}) {
    const MotionAnalysis a = optimise_motion(system, motion, system.model().default_pose(), frame_times(0.0, 1.0, 50.0),
                                             {.force = force, .reserve = {1.0, 1.0}}, progress);
    Kinematics<double> kinematics(system.mechanism());
    PathWorkspace<double> workspace(system.paths());
    for (Eigen::Index i = 0; i < a.q.rows(); ++i) {
      const Eigen::VectorXd q = a.q.row(i);
      update_positions(system.mechanism(), q.data(), kinematics);
      system.paths().evaluate(kinematics, q.data(), workspace);
      Eigen::VectorXd moment = a.reserve.row(i);
      for (std::size_t k = 0; k < workspace.gradient.size(); ++k) {
        moment(system.paths().pairs()[k].coordinate) -=
            workspace.gradient[k] * a.force(i, system.paths().pairs()[k].muscle);
      }
      EXPECT_LT((moment - a.moment.row(i).transpose()).cwiseAbs().maxCoeff(), 1e-6);
    }
  }
}

/// A foot that turns a crank there and back: hip and knee follow so that the loop stays closed.
Motion turning_crank(const MusculoskeletalSystem& system) {
  SignalTable table;
  table.names = {"hip_flexion", "knee_extension", "crank_angle"};
  table.values.resize(3);
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.005 * i;
    Eigen::VectorXd q = system.model().default_pose();
    q(2) += 0.2 * std::sin(6.0 * t);
    const Assembly closed = assemble(system, q, Eigen::VectorXd::Zero(3));
    table.time.push_back(t);
    for (std::size_t c = 0; c < 3; ++c) table.values[c].push_back(closed.q(static_cast<Eigen::Index>(c)));
  }
  return make_motion(table, system.model());
}

TEST(MotionAnalysis, OfAClosedLoopGivesTheForcesThatReproduceItsMotion) {
  const MusculoskeletalSystem system(read_osim(veridyn::test::source_folder() / "examples/studies/muscle/pedals.osim"));
  const Motion motion = turning_crank(system);
  Progress progress;
  const MotionAnalysis a = optimise_motion(system, motion, system.model().default_pose(), frame_times(0.0, 0.5, 100.0),
                                           {.force = StaticForce::kWithPassive, .reserve = {0.0, 0.0, 5.0}}, progress);
  EXPECT_TRUE(a.infeasible.empty());
  EXPECT_EQ(a.loop_gap.constraint, "PointConstraint 'foot_on_pedal'");
  EXPECT_LT(a.loop_gap.error, 1e-9);
  EXPECT_GT(a.force.maxCoeff(), 50.0);
  SystemEvaluator<double> evaluator(system);
  const auto pairs = system.pairs();
  for (Eigen::Index i = 5; i + 5 < a.q.rows(); ++i) {
    const Eigen::VectorXd q = a.q.row(i), qdot = a.qdot.row(i), moment = a.moment.row(i);
    evaluator.set_pose(q.data(), qdot.data());
    Eigen::VectorXd tau = a.reserve.row(i), acceleration(3);
    for (std::size_t k = 0; k < pairs.size(); ++k)
      tau(pairs[k].coordinate) -= a.force(i, pairs[k].muscle) * evaluator.path_gradient()[k];
    evaluator.add_passive_forces(tau.data());
    ASSERT_TRUE(evaluator.dynamics().forward_dynamics(tau.data(), nullptr, acceleration.data()).usable());
    for (Eigen::Index c = 0; c < 3; ++c)
      EXPECT_NEAR(acceleration(c), a.qddot(i, c), 1e-6 * a.qddot.cwiseAbs().maxCoeff()) << a.time[at(i)];
    // Of all forces that give the motion the reported ones are the least: along what the loops allow.
    const LoopSolver<double>& loops = evaluator.dynamics().update_loops();
    for (int r = 0; r < loops.rows(); ++r) {
      double across = 0.0;
      for (Eigen::Index c = 0; c < 3; ++c) across += loops.jacobian(r)[c] * moment(c);
      EXPECT_NEAR(across, 0.0, 1e-10 * moment.norm());
    }
  }
}

// One muscle on the one motion that the loop leaves: its force is determined, whatever the muscle is like.
TEST(MotionAnalysis, FindsTheForceOfTheOnlyMuscleOfAClosedLoopThatWasSimulatedForward) {
  Model model = read_osim(veridyn::test::source_folder() / "examples/studies/muscle/pedals.osim");
  model.muscles.resize(1);
  model.muscles[0].parameters.max_control = 10.0;  // its force, passive for a good part, is above F0
  const MusculoskeletalSystem system(model);
  Progress progress;
  const MuscleTrajectory forward =
      simulate_forward(system, default_start(model), {.excitation = ControlSignals({0.3}), .reserve = {}},
                       {.end = 0.2, .rate_Hz = 500.0, .accuracy = 1e-11}, progress);
  ASSERT_TRUE(forward.usable()) << forward.message();
  SignalTable table;
  table.names = {"hip_flexion", "knee_extension", "crank_angle"};
  table.time = forward.time;
  for (Eigen::Index c = 0; c < 3; ++c) table.values.emplace_back(forward.q.col(c).begin(), forward.q.col(c).end());
  const MotionAnalysis a = optimise_motion(system, make_motion(table, model), model.default_pose(), forward.time,
                                           {.force = StaticForce::kIsometric}, progress);
  EXPECT_TRUE(a.infeasible.empty());
  double worst = 0.0;
  for (Eigen::Index i = 10; i + 10 < a.q.rows(); ++i)
    worst = std::max(worst, std::abs(a.force(i, 0) / forward.tendon_force(i, 0) - 1.0));
  EXPECT_LT(worst, 1e-6);
}

TEST(MotionAnalysis, NamesTheLoopThatAMotionDoesNotClose) {
  const MusculoskeletalSystem system(read_osim(veridyn::test::source_folder() / "examples/studies/muscle/pedals.osim"));
  Motion motion = turning_crank(system);
  const double knee = motion.coordinate[1]->evaluate(0.0).value;
  motion.coordinate[1] = numerics::PiecewisePolynomial::constant(knee + 0.05);
  const MotionAnalysis a = analyse_motion(system, motion, system.model().default_pose(), frame_times(0.0, 0.5, 20.0));
  EXPECT_EQ(a.loop_gap.constraint, "PointConstraint 'foot_on_pedal'");
  EXPECT_GT(a.loop_gap.error, 0.01);
}

}  // namespace
}  // namespace veridyn::muscle
