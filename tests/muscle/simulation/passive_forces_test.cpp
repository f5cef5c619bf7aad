#include "veridyn/muscle/simulation/passive_forces.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"

namespace veridyn::muscle {
namespace {

/// A mass on a vertical slider, with forces.
Model on_a_slider(const std::string& forces) {
  return OsimFile::parse(
             R"(<OpenSimDocument Version="40000"><Model name="m"><gravity>0 -10 0</gravity><BodySet><objects>
<Body name="mass"><mass>2</mass><inertia>0.1 0.1 0.1 0 0 0</inertia></Body></objects></BodySet>
<JointSet><objects><SliderJoint name="rail"><socket_parent_frame>up</socket_parent_frame>
<socket_child_frame>along</socket_child_frame><coordinates><Coordinate name="height"/></coordinates>
<frames><PhysicalOffsetFrame name="up"><socket_parent>/ground</socket_parent><orientation>0 0 1.5707963267948966
</orientation></PhysicalOffsetFrame><PhysicalOffsetFrame name="along"><socket_parent>/bodyset/mass</socket_parent>
<orientation>0 0 1.5707963267948966</orientation></PhysicalOffsetFrame></frames></SliderJoint></objects></JointSet>
<ContactGeometrySet><objects><ContactHalfSpace name="floor"><socket_frame>/ground</socket_frame><orientation>
0 0 -1.5707963267948966</orientation></ContactHalfSpace><ContactSphere name="ball"><socket_frame>/bodyset/mass
</socket_frame><radius>0.1</radius></ContactSphere></objects></ContactGeometrySet>
<ForceSet><objects>)" +
                 forces + "</objects></ForceSet></Model></OpenSimDocument>",
             "m.osim")
      .model();
}

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
  ASSERT_EQ(t.end, SimulationEnd::kCompleted);
  for (std::size_t i = 0; i < t.time.size(); ++i)
    EXPECT_NEAR(t.q(i, 0), y0 - 0.05 * std::cos(omega * t.time[i]), 1e-7) << t.time[i];
}

TEST(PassiveForces, ALigamentHoldsAMassWhereItsCurveCarriesTheWeight) {
  // Curve strain: force 40 strain, against 20 N: strain 0.5, length 0.6, height 0.4, released there.
  const Model model =
      on_a_slider(std::string("<Ligament name=\"l\">") + kPathText +
                  "<resting_length>0.4</resting_length><pcsa_force>40</pcsa_force><PiecewiseLinearFunction "
                  "name=\"force_length_curve\"><x>0 1 2</x><y>0 1 2</y></PiecewiseLinearFunction></Ligament>");
  const MuscleTrajectory t = released(model, 0.4, 0.5);
  ASSERT_EQ(t.end, SimulationEnd::kCompleted);
  EXPECT_NEAR(t.q(t.q.rows() - 1, 0), 0.4, 1e-9);
  // Slack it does nothing: free fall.
  const MuscleTrajectory fall = released(model, 0.7, 0.1);
  EXPECT_NEAR(fall.q(fall.q.rows() - 1, 0), 0.7 - 0.5 * 10.0 * 0.01, 1e-9);
}

TEST(PassiveForces, ABallBouncesToItsHeightAndWithDissipationComesToRest) {
  const auto contact = [](const char* dissipation) {
    return std::string(
               "<HuntCrossleyForce name=\"c\"><HuntCrossleyForce::ContactParametersSet name=\"contact_parameters\">"
               "<objects><HuntCrossleyForce::ContactParameters><geometry>floor "
               "ball</geometry><stiffness>1e5</stiffness>"
               "<dissipation>") +
           dissipation +
           "</dissipation></HuntCrossleyForce::ContactParameters></objects></HuntCrossleyForce::ContactParametersSet>"
           "</HuntCrossleyForce>";
  };
  const MuscleTrajectory bounce = released(on_a_slider(contact("0")), 0.2, 2.0);
  ASSERT_EQ(bounce.end, SimulationEnd::kCompleted);
  const double k = 4.0 / 3.0 * 1e5 / std::pow(2.0, 1.5) * std::sqrt(0.1);
  double lowest = 1.0;
  for (Eigen::Index i = 0; i < bounce.q.rows(); ++i) {
    const double depth = std::max(0.0, 0.1 - bounce.q(i, 0));
    const double energy =
        bounce.qdot(i, 0) * bounce.qdot(i, 0) + 20.0 * bounce.q(i, 0) + 0.4 * k * std::pow(depth, 2.5);
    EXPECT_NEAR(energy, 20.0 * 0.2, 1e-5) << bounce.time[i];
    lowest = std::min(lowest, bounce.q(i, 0));
  }
  EXPECT_LT(lowest, 0.1);
  const MuscleTrajectory rest = released(on_a_slider(contact("20")), 0.12, 4.0);
  ASSERT_EQ(rest.end, SimulationEnd::kCompleted);
  EXPECT_NEAR(rest.q(rest.q.rows() - 1, 0), 0.1 - std::pow(20.0 / k, 2.0 / 3.0), 1e-4);
}

}  // namespace
}  // namespace veridyn::muscle
