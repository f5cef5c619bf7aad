#include "veridyn/muscle/simulation/computed_muscle_control.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "tests/muscle/reference_table.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"
#include "veridyn/muscle/simulation/motion_analysis.hpp"
#include "veridyn/muscle/simulation/muscle_window.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"

namespace veridyn::muscle {
namespace {

#define SKIP_WITHOUT_REFERENCE()                                                      \
  if (!std::filesystem::exists(veridyn::test::shared_folder() / "reference/opensim")) \
  GTEST_SKIP() << "OpenSim's results of ../shared/reference are not here"

/// Elbow from `from` to `to` within a second by minimum jerk, shoulder at rest.
Motion minimum_jerk(const Model& model, double from, double to) {
  SignalTable table;
  table.source = "minimum jerk";
  table.names = {model.coordinates[0].name, model.coordinates[1].name};
  table.values.resize(2);
  for (int i = -100; i <= 300; ++i) {
    const double t = 0.005 * i, s = std::clamp(t, 0.0, 1.0);
    table.time.push_back(t);
    table.values[0].push_back(0.0);
    table.values[1].push_back(from + (to - from) * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s));
  }
  return make_motion(table, model);
}

TEST(ComputedMuscleControl, FollowsAMotionAndItsReplayIsItself) {
  const MusculoskeletalSystem system(load_model("arm").model());
  const Motion motion = minimum_jerk(system.model(), 0.3, 1.6);
  Progress progress;
  const ControlOptions options{.end = 1.0};
  const ControlResult r = computed_muscle_control(system, motion, options, progress);
  ASSERT_TRUE(r.usable()) << r.trajectory.message();
  EXPECT_LT(r.tracking_error(0), 3e-3);
  EXPECT_LT(r.tracking_error(1), 3e-3);
  const MuscleTrajectory replay =
      simulate_forward(system, r.start, r.drive, {.end = 1.0, .accuracy = options.accuracy}, progress);
  EXPECT_EQ(replay.q, r.trajectory.q);
  // The motion is the controls', not the step sizes': found at a finer accuracy, a finer replay yet stays with it.
  const ControlResult fine = computed_muscle_control(system, motion, {.end = 0.5, .accuracy = 1e-9}, progress);
  const MuscleTrajectory finer =
      simulate_forward(system, fine.start, fine.drive, {.end = 0.5, .accuracy = 1e-10}, progress);
  EXPECT_LT((finer.q - fine.trajectory.q).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(ComputedMuscleControl, ExcitationsStayWithinTheirBounds) {
  const MusculoskeletalSystem system(load_model("arm").model());
  Progress progress;
  const ControlResult r = computed_muscle_control(system, minimum_jerk(system.model(), 0.3, 1.2),
                                                  {.end = 0.5, .min_control = 0.03, .max_control = 0.6}, progress);
  ASSERT_TRUE(r.usable());
  EXPECT_GE(r.trajectory.excitation.minCoeff(), 0.03);
  EXPECT_LE(r.trajectory.excitation.maxCoeff(), 0.6);
}

TEST(ComputedMuscleControl, MissingCoordinatesAndSenselessOptionsAreNamed) {
  const MusculoskeletalSystem system(load_model("arm").model());
  Motion motion = minimum_jerk(system.model(), 0.3, 1.2);
  motion.coordinate[1].reset();
  Progress progress;
  EXPECT_THROW(
      {
        try {
          (void)computed_muscle_control(system, motion, {}, progress);
        } catch (const InputError& error) {
          EXPECT_THAT(error.what(), ::testing::HasSubstr("'elbow_flexion' is free but not in the motion"));
          throw;
        }
      },
      InputError);
  EXPECT_THROW(
      (void)computed_muscle_control(system, minimum_jerk(system.model(), 0.3, 1.2), {.window = -1.0}, progress),
      InputError);
}

TEST(ComputedMuscleControl, FindsOpenSimsActivationsAndTracksCloser) {
  SKIP_WITHOUT_REFERENCE();
  const test::ReferenceTable table = test::read_reference("opensim/d_arm26_cmc.csv");
  const MusculoskeletalSystem system(read_osim(veridyn::test::shared_folder() / "data/opensim/arm26.osim"));
  const Motion motion =
      make_motion(read_signals(veridyn::test::shared_folder() / "reference/opensim/minjerk_elbow.mot"), system.model());
  Progress progress;
  const ControlResult r = computed_muscle_control(system, motion, {.end = 1.01, .rate_Hz = 1000.0}, progress);
  ASSERT_TRUE(r.usable());
  double opensim = 0.0;
  std::vector<double> sum(6, 0.0);
  std::size_t rows = 0;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const double t = table.number(i, "time_s");
    if (t > 1.0) break;
    const auto at = static_cast<Eigen::Index>(std::lround(t * 1000.0));
    opensim =
        std::max(opensim, std::abs(table.number(i, "r_elbow_flex_rad") - table.number(i, "desired_r_elbow_flex_rad")));
    ++rows;
    for (std::size_t m = 0; m < 6; ++m) {
      sum[m] += std::abs(r.trajectory.activation(at, static_cast<Eigen::Index>(m)) -
                         table.number(i, system.model().muscles[m].name() + "_activation"));
    }
  }
  EXPECT_LT(r.tracking_error(1), 3e-3);
  EXPECT_LT(r.tracking_error(1), opensim);
  for (const double s : sum) EXPECT_LT(s / static_cast<double>(rows), 0.02);
}

TEST(MuscleWindow, TheExcitationItFindsEndsAtTheWishedForce) {
  const MusculoskeletalSystem system(load_model("arm").model());
  SystemEvaluator<double> evaluator(system);
  std::vector<double> x(system.layout().size, 0.0), a(6, 0.1);
  x[1] = 0.8;
  evaluator.set_motion(x.data(), x.data() + 2);
  evaluator.start_muscles(a.data(), x.data());
  MuscleWindow window(system);
  std::array<std::vector<double>, MuscleWindow::kNodes> lengths;
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    lengths[k].assign(evaluator.path_length().begin(), evaluator.path_length().end());
    for (double& l : lengths[k]) l += 1e-4 * static_cast<double>(k);
  }
  window.set_paths(0.01, lengths);
  window.set_states(evaluator.activation(), evaluator.fiber_length());
  const std::vector<double> low(6, 0.02), high(6, 1.0);
  std::vector<double> force_low(6), force_high(6), wished(6), u(6), reached(6);
  ASSERT_TRUE(window.end_forces(low, 1e-8, force_low));
  ASSERT_TRUE(window.end_forces(high, 1e-8, force_high));
  for (std::size_t m = 0; m < 6; ++m) {
    EXPECT_GT(force_high[m], force_low[m]);
    wished[m] = force_low[m] + (0.1 + 0.15 * static_cast<double>(m)) * (force_high[m] - force_low[m]);
  }
  ASSERT_TRUE(window.find_excitations(low, high, force_low, force_high, wished, 1e-8, u));
  ASSERT_TRUE(window.end_forces(u, 1e-8, reached));
  for (std::size_t m = 0; m < 6; ++m) EXPECT_NEAR(reached[m], wished[m], 2e-6 * (force_high[m] - force_low[m]));
}

TEST(MotionAnalysis, StaticOptimisationOfAMotionIsOpenSims) {
  SKIP_WITHOUT_REFERENCE();
  const test::ReferenceTable table = test::read_reference("opensim/d_arm26_static_optimization.csv");
  const MusculoskeletalSystem system(read_osim(veridyn::test::shared_folder() / "data/opensim/arm26.osim"),
                                     {.paths = PathSource::kAsOpenSim});
  const Motion motion =
      make_motion(read_signals(veridyn::test::shared_folder() / "reference/opensim/minjerk_elbow.mot"), system.model());
  Progress progress;
  const MotionAnalysis a = optimise_motion(system, motion, system.model().default_pose(), frame_times(0.0, 1.0, 200.0),
                                           {.reserve = {1.0, 1.0}}, progress);
  ASSERT_EQ(a.time.size(), table.rows.size());
  EXPECT_TRUE(a.infeasible.empty());
  for (std::size_t i = 0; i < a.time.size(); ++i) {
    // The jerk of this motion jumps at its ends: there any spline rings, and each its own way.
    const double tolerance = a.time[i] < 0.02 || a.time[i] > 0.98 ? 3e-4 : 1e-4;
    for (std::size_t m = 0; m < 6; ++m) {
      EXPECT_NEAR(a.activation(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(m)),
                  table.number(i, system.model().muscles[m].name() + "_activation"), tolerance)
          << a.time[i];
    }
  }
}

TEST(MotionAnalysis, MomentsAreMadeByTheMuscles) {
  const MusculoskeletalSystem system(load_model("arm").model());
  const Motion motion = minimum_jerk(system.model(), 0.3, 1.6);
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

}  // namespace
}  // namespace veridyn::muscle
