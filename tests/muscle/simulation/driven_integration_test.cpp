#include "veridyn/muscle/simulation/driven_integration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

using ::testing::Contains;
using ::testing::Each;

/// All excitations 0.05, from 0.033 s on 0.2.
MuscleControls step_at_33_ms() {
  std::vector<double> value(6, 0.05);
  value.insert(value.end(), 6, 0.2);
  return {ControlSignals({0.0, 0.033}, value, 6, Interpolation::kHold), {}};
}

TEST(ControlsAtInstant, HeldSignalsKeepTheirValueUntilThePieceEnds) {
  const MuscleControls controls = step_at_33_ms();
  ControlsAtInstant signals(controls, 6, 2);
  signals.begin_piece(0.0);
  EXPECT_EQ(signals.piece_end(0.0), 0.033);
  EXPECT_THAT(signals.at(0.033).excitation, Each(0.05));
  signals.begin_piece(0.033);
  EXPECT_EQ(signals.at(0.033).excitation[0], 0.2);
  EXPECT_EQ(signals.piece_end(0.033), kInfinity);
  EXPECT_TRUE(signals.at(0.0).coordinate_force.empty());
}

class DrivenIntegration : public ::testing::Test {
 protected:
  /// Times at which steps ended, none after `stop`; the last is where the state is.
  std::vector<double> run(double stop) {
    std::vector<double> x(system.layout().size, 0.0), activation(6, 0.05), ends;
    x[1] = 0.8;
    evaluator.set_motion(x.data(), x.data() + 2);
    evaluator.start_muscles(activation.data(), x.data());
    const MuscleControls controls = step_at_33_ms();
    ControlsAtInstant signals(controls, 6, 2);
    signals.begin_piece(0.0);
    SystemStepper stepper(system, {.tolerance = 1e-6});
    double t = 0.0;
    end = integrate_driven(evaluator, signals, stepper, t, x.data(), 0.1, [&](double, double to) {
      ends.push_back(to);
      return to < stop;
    });
    reached = t;
    return ends;
  }
  MusculoskeletalSystem system{load_model("arm").model()};
  SystemEvaluator<double> evaluator{system};
  numerics::IntegrationEnd end = numerics::IntegrationEnd::kNotFinite;
  double reached = 0.0;
};

TEST_F(DrivenIntegration, AStepEndsWhereAHeldSignalJumps) {
  const std::vector<double> ends = run(1.0);
  EXPECT_EQ(end, numerics::IntegrationEnd::kReached);
  EXPECT_EQ(reached, 0.1);
  EXPECT_THAT(ends, Contains(0.033));
  EXPECT_EQ(ends.back(), 0.1);
}

TEST_F(DrivenIntegration, TheCallerCanStopIt) {
  const std::vector<double> ends = run(0.05);
  EXPECT_EQ(end, numerics::IntegrationEnd::kReached);
  EXPECT_EQ(reached, ends.back());
  EXPECT_GE(reached, 0.05);
  EXPECT_LT(reached, 0.1);
}

}  // namespace
}  // namespace veridyn::muscle
