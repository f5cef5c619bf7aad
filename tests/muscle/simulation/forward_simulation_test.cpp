#include "veridyn/muscle/simulation/forward_simulation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/support/folders.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::muscle {
namespace {

using ::testing::HasSubstr;

MuscleControls constant_drive(std::size_t muscles, double excitation) {
  return {ControlSignals(std::vector<double>(muscles, excitation)), {}};
}

class BuiltInArm : public ::testing::Test {
 protected:
  MusculoskeletalSystem system{load_model("arm").model()};
  StartState start = default_start(system.model());
  Progress progress;
};

TEST_F(BuiltInArm, TighterAccuracyConvergesToOneMotion) {
  const MuscleControls controls = constant_drive(6, 0.1);
  const MuscleTrajectory exact = simulate_forward(system, start, controls, {.end = 0.5, .accuracy = 1e-10}, progress);
  ASSERT_TRUE(exact.usable());
  for (const double accuracy : {1e-4, 1e-6}) {
    const MuscleTrajectory t = simulate_forward(system, start, controls, {.end = 0.5, .accuracy = accuracy}, progress);
    EXPECT_LT((t.q - exact.q).cwiseAbs().maxCoeff(), 20.0 * accuracy);
    EXPECT_LT(t.steps, exact.steps);
  }
}

TEST_F(BuiltInArm, RowsAreTheSameWhateverTheirRate) {
  const MuscleControls controls = constant_drive(6, 0.1);
  const MuscleTrajectory coarse = simulate_forward(system, start, controls, {.end = 0.4, .rate_Hz = 50.0}, progress);
  const MuscleTrajectory fine = simulate_forward(system, start, controls, {.end = 0.4, .rate_Hz = 500.0}, progress);
  ASSERT_EQ(coarse.time.size(), 21u);
  ASSERT_EQ(fine.time.size(), 201u);
  for (Eigen::Index i = 0; i < 21; ++i) EXPECT_EQ(coarse.q.row(i), fine.q.row(10 * i));
  const MuscleTrajectory steps = simulate_forward(system, start, controls, {.end = 0.4, .rate_Hz = 0.0}, progress);
  EXPECT_DOUBLE_EQ(steps.time.back(), 0.4);
  EXPECT_NEAR(steps.q.row(steps.q.rows() - 1)(1), fine.q(200, 1), 1e-12);
}

TEST_F(BuiltInArm, ResultsAreBitForBitTheSameOnOneAndTwoThreads) {
  const auto run = [&](int threads) {
    std::vector<Eigen::VectorXd> ends(8);
    numerics::parallel_for(ends.size(), threads, [&](std::size_t i) {
      Progress quiet;
      ends[i] =
          simulate_forward(system, start, constant_drive(6, 0.02 + 0.05 * static_cast<double>(i)), {.end = 0.2}, quiet)
              .final_state;
    });
    return ends;
  };
  const auto one = run(1), two = run(2);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i], two[i]);
}

TEST_F(BuiltInArm, AHeldStepOfTheExcitationActsFromItsInstantOn) {
  const std::vector<double> rest(6, 0.05);
  std::vector<double> value = rest;
  value.insert(value.end(), 6, 0.5);
  const MuscleControls step{ControlSignals({0.0, 0.1}, value, 6, Interpolation::kHold), {}};
  const MuscleTrajectory a = simulate_forward(system, start, step, {.end = 0.2}, progress);
  const MuscleTrajectory b = simulate_forward(system, start, constant_drive(6, 0.05), {.end = 0.2}, progress);
  EXPECT_LT((a.activation.topRows(21) - b.activation.topRows(21)).cwiseAbs().maxCoeff(), 1e-6);
  // a' = (u - a)/(tau (0.5 + 1.5 a)) from 0.05 on: (1 - e^{-t/tau}) to first order.
  EXPECT_GT(a.activation(22, 0), 0.2);
}

TEST_F(BuiltInArm, SlackTendonsAndShortestFibresAreFoundAsEvents) {
  // An elbow that starts to flex fast: flexors' tendons go slack.
  start.q(1) = 0.3;
  start.qdot(1) = 25.0;
  const MuscleTrajectory t =
      simulate_forward(system, start, constant_drive(6, 0.01), {.end = 0.08, .accuracy = 1e-7}, progress);
  ASSERT_FALSE(t.events.empty());
  for (const MuscleEvent& e : t.events) {
    EXPECT_GE(e.time, 0.0);
    EXPECT_LE(e.time, 0.08);
    EXPECT_FALSE(event_text(e.kind).empty());
  }
}

TEST_F(BuiltInArm, LockedCoordinatesStayWhereTheyStart) {
  const MusculoskeletalSystem locked(load_model("arm").model(), {.locked = {"shoulder_flexion"}});
  start.q(0) = 0.4;
  const MuscleTrajectory t = simulate_forward(locked, start, constant_drive(6, 0.1), {.end = 0.3}, progress);
  ASSERT_TRUE(t.usable());
  EXPECT_EQ(t.q.col(0).minCoeff(), 0.4);
  EXPECT_EQ(t.q.col(0).maxCoeff(), 0.4);
  EXPECT_GT((t.q.col(1).array() - start.q(1)).abs().maxCoeff(), 1e-3);
}

TEST_F(BuiltInArm, RigidTendonsHaveNoFibreStateAndMoveMuchAlike) {
  Model model = load_model("arm").model();
  for (Muscle& muscle : model.muscles) muscle.parameters.rigid_tendon = true;
  const MusculoskeletalSystem rigid(model);
  EXPECT_EQ(rigid.layout().size, 4u + 6u);
  const MuscleTrajectory a = simulate_forward(rigid, start, constant_drive(6, 0.05), {.end = 0.3}, progress);
  const MuscleTrajectory b = simulate_forward(system, start, constant_drive(6, 0.05), {.end = 0.3}, progress);
  ASSERT_TRUE(a.usable());
  EXPECT_LT((a.q - b.q).cwiseAbs().maxCoeff(), 0.2);
  EXPECT_GT(a.fiber_length.minCoeff(), 0.0);
}

TEST_F(BuiltInArm, ADivergingSimulationEndsAndSaysWhichStateAndWhen) {
  // A reserve that pulls ever harder, far beyond what a body survives.
  const MuscleControls controls{ControlSignals(std::vector<double>(6, 0.05)),
                                ControlSignals(std::vector<double>{1e9, 1e9})};
  const MuscleTrajectory t = simulate_forward(system, start, controls, {.end = 10.0, .max_steps = 2000}, progress);
  EXPECT_FALSE(t.usable());
  EXPECT_LT(t.end_time, 10.0);
  EXPECT_THAT(t.message(), HasSubstr("coordinate"));
  EXPECT_TRUE(t.q.allFinite());
  EXPECT_EQ(static_cast<std::size_t>(t.q.rows()), t.time.size());
}

TEST_F(BuiltInArm, AStepLimitEndsTheRun) {
  const MuscleTrajectory t = simulate_forward(system, start, constant_drive(6, 0.1), {.max_steps = 10}, progress);
  EXPECT_EQ(t.end, MotionEnd::kStepLimit);
  EXPECT_THAT(t.message(), HasSubstr("limit of"));
}

TEST(ForwardSimulation, ACoupledCoordinateMayStartOutsideItsRange) {
  Model model = load_model("arm").model();
  model.couplers.push_back({"twice", 0, 1, numerics::PiecewisePolynomial::linear(2.0, -1.0)});
  model.coordinates[0].default_value = 0.1;  // the elbow at -0.8 rad, below its range
  const MusculoskeletalSystem system(model);
  Progress progress;
  const MuscleTrajectory t =
      simulate_forward(system, default_start(system.model()), constant_drive(6, 0.1), {.end = 0.02}, progress);
  EXPECT_EQ(t.end, MotionEnd::kCompleted);
}

TEST_F(BuiltInArm, StartsOutsideTheRangeOrNotFiniteAreRefusedByName) {
  const auto message = [&](double elbow) {
    start.q(1) = elbow;
    try {
      (void)simulate_forward(system, start, constant_drive(6, 0.1), {}, progress);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(message(3.0), HasSubstr("start of coordinate 'elbow_flexion' = 3 rad is outside its range 0 .. 2.2689"));
  EXPECT_THAT(message(NAN), HasSubstr("'elbow_flexion' is not a finite number"));
}

TEST(ForwardSimulation, RunsEveryModelOfOpenSim) {
  if (!std::filesystem::exists(veridyn::test::shared_folder() / "data/opensim"))
    GTEST_SKIP() << "the OpenSim models of ../shared/data are not here";
  for (const auto& entry : std::filesystem::directory_iterator(veridyn::test::shared_folder() / "data/opensim")) {
    if (entry.path().extension() != ".osim") continue;
    SCOPED_TRACE(entry.path().filename().string());
    const MusculoskeletalSystem system(read_osim(entry.path()), {.without_unsupported = true});
    StartState start = default_start(system.model());
    for (Eigen::Index i = 0; i < start.q.size(); ++i) {
      const Coordinate& c = system.model().coordinates[i];
      start.q(i) = std::clamp(start.q(i), c.low, c.high);
    }
    Progress progress;
    const MuscleTrajectory t =
        simulate_forward(system, start, constant_drive(system.muscles().size(), 0.05), {.end = 0.02}, progress);
    EXPECT_TRUE(t.usable()) << t.message();
    EXPECT_TRUE(t.q.allFinite());
  }
}

}  // namespace
}  // namespace veridyn::muscle
