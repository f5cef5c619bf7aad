#include "veridyn/muscle/simulation/passive_forces.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/muscle/mass_on_slider.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"

namespace veridyn::muscle {
namespace {

constexpr const char* kPathText =
    "<GeometryPath><PathPointSet><objects><PathPoint name=\"a\"><socket_parent_frame>/ground</socket_parent_frame>"
    "<location>0 1 0</location></PathPoint><PathPoint name=\"b\"><socket_parent_frame>/bodyset/mass"
    "</socket_parent_frame><location>0 0 0</location></PathPoint></objects></PathPointSet></GeometryPath>";

MuscleTrajectory released(const Model& model, double height, double end) {
  const MusculoskeletalSystem system(model);
  StartState start = default_start(system.model());
  start.q(0) = height;
  Progress progress;
  return simulate_forward(system, start, {ControlSignals(std::vector<double>{}), {}},
                          {.end = end, .rate_Hz = 100.0, .accuracy = 1e-9}, progress);
}

TEST(PassiveForces, AMassOnAPathSpringSwingsAsItsEquationSays) {
  // m y'' = -m g + k (1 - y - L0) while the spring is taut: about y0 with omega = sqrt(k/m).
  const Model model = on_a_slider(std::string("<PathSpring name=\"s\">") + kPathText +
                                  "<resting_length>0.3</resting_length><stiffness>200</stiffness></PathSpring>");
  const double y0 = 1.0 - 0.3 - 2.0 * 10.0 / 200.0, omega = 10.0;
  const MuscleTrajectory t = released(model, y0 - 0.05, 1.0);
  ASSERT_EQ(t.end, MotionEnd::kCompleted);
  for (std::size_t i = 0; i < t.time.size(); ++i)
    EXPECT_NEAR(t.q(i, 0), y0 - 0.05 * std::cos(omega * t.time[i]), 1e-7) << t.time[i];
}

TEST(PassiveForces, AFormulaOnACoordinateSwingsAMassAsItsEquationSays) {
  // m y'' = -m g - k q: about -m g/k with omega = sqrt(k/m).
  const Model model = on_a_slider(
      "<ExpressionBasedCoordinateForce name=\"f\"><coordinate>height</coordinate><expression>-200*q</expression>"
      "</ExpressionBasedCoordinateForce>");
  const MuscleTrajectory t = released(model, 0.05, 1.0);
  ASSERT_EQ(t.end, MotionEnd::kCompleted);
  for (std::size_t i = 0; i < t.time.size(); ++i)
    EXPECT_NEAR(t.q(i, 0), -0.1 + 0.15 * std::cos(10.0 * t.time[i]), 1e-7) << t.time[i];
}

TEST(PassiveForces, ALigamentHoldsAMassWhereItsCurveCarriesTheWeight) {
  // Curve strain: force 40 strain, against 20 N: strain 0.5, length 0.6, height 0.4, released there.
  const Model model =
      on_a_slider(std::string("<Ligament name=\"l\">") + kPathText +
                  "<resting_length>0.4</resting_length><pcsa_force>40</pcsa_force><PiecewiseLinearFunction "
                  "name=\"force_length_curve\"><x>0 1 2</x><y>0 1 2</y></PiecewiseLinearFunction></Ligament>");
  const MuscleTrajectory t = released(model, 0.4, 0.5);
  ASSERT_EQ(t.end, MotionEnd::kCompleted);
  EXPECT_NEAR(t.q(t.q.rows() - 1, 0), 0.4, 1e-9);
  // Slack it does nothing: free fall.
  const MuscleTrajectory fall = released(model, 0.7, 0.1);
  EXPECT_NEAR(fall.q(fall.q.rows() - 1, 0), 0.7 - 0.5 * 10.0 * 0.01, 1e-9);
}

TEST(PassiveForces, ABallBouncesToItsHeightAndWithDissipationComesToRest) {
  const MuscleTrajectory bounce = released(on_a_slider(ball_on_floor("0")), 0.2, 2.0);
  ASSERT_EQ(bounce.end, MotionEnd::kCompleted);
  const double k = kBallStiffness;
  double lowest = 1.0;
  for (Eigen::Index i = 0; i < bounce.q.rows(); ++i) {
    const double depth = std::max(0.0, 0.1 - bounce.q(i, 0));
    const double energy =
        bounce.qdot(i, 0) * bounce.qdot(i, 0) + 20.0 * bounce.q(i, 0) + 0.4 * k * std::pow(depth, 2.5);
    EXPECT_NEAR(energy, 20.0 * 0.2, 1e-5) << bounce.time[i];
    lowest = std::min(lowest, bounce.q(i, 0));
  }
  EXPECT_LT(lowest, 0.1);
  const MuscleTrajectory rest = released(on_a_slider(ball_on_floor("20")), 0.12, 4.0);
  ASSERT_EQ(rest.end, MotionEnd::kCompleted);
  EXPECT_NEAR(rest.q(rest.q.rows() - 1, 0), 0.1 - std::pow(20.0 / k, 2.0 / 3.0), 1e-4);
}

}  // namespace
}  // namespace veridyn::muscle
