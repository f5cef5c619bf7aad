#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/path/muscle_path.hpp"

namespace veridyn::muscle {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A pendulum with a cylinder on the ground and these forces.
Model pendulum(const std::string& forces) {
  return OsimFile::parse(R"xml(<?xml version="1.0"?>
<OpenSimDocument Version="40000"><Model name="pendulum">
<Ground name="ground"><WrapObjectSet><objects><WrapCylinder name="drum">
<translation>0 0 0</translation><radius>0.02</radius><length>0.2</length></WrapCylinder>
</objects></WrapObjectSet></Ground>
<BodySet><objects><Body name="rod"><mass>1</mass><mass_center>0 -0.2 0</mass_center>
<inertia>0.1 0.1 0.1 0 0 0</inertia></Body></objects></BodySet>
<JointSet><objects><PinJoint name="hinge">
<socket_parent_frame>/ground</socket_parent_frame><socket_child_frame>/bodyset/rod</socket_child_frame>
<coordinates><Coordinate name="swing"><range>-2 2</range></Coordinate></coordinates>
</PinJoint></objects></JointSet>
<ForceSet><objects>)xml" + forces +
                             "</objects></ForceSet></Model></OpenSimDocument>",
                         "pendulum.osim")
      .model();
}

const std::string kPoints = R"xml(<PathPoint name="a"><socket_parent_frame>/ground</socket_parent_frame>
<location>0.1 0 0</location></PathPoint><PathPoint name="b"><socket_parent_frame>/bodyset/rod</socket_parent_frame>
<location>0 -0.1 0</location></PathPoint>)xml";

/// A muscle of this class, with further elements, points and wraps.
std::string muscle_of(const std::string& type, const std::string& more = "", const std::string& points = kPoints,
                      const std::string& wraps = "") {
  return "<" + type + " name=\"m\">" + more + "<GeometryPath name=\"path\"><PathPointSet><objects>" + points +
         "</objects></PathPointSet><PathWrapSet><objects>" + wraps + "</objects></PathWrapSet></GeometryPath></" +
         type + ">";
}

/// The same muscle with all its points on the ground.
std::string with_ground_points(std::string text) {
  for (std::size_t at; (at = text.find("/bodyset/rod")) != std::string::npos;) text.replace(at, 12, "/ground");
  return text;
}

std::string refused(const std::string& forces) {
  return why([&] { static_cast<void>(pendulum(forces)); });
}

// Activation and deactivation time constants of the classes of OpenSim 4.5.
TEST(OsimMuscle, HasTheDefaultsOfItsClass) {
  const auto times = [](const char* type) {
    const MusculotendonParameters<double> p = pendulum(muscle_of(type)).muscles.at(0).parameters.musculotendon;
    return std::pair(p.activation_time_constant, p.deactivation_time_constant);
  };
  EXPECT_EQ(times("Thelen2003Muscle"), std::pair(0.015, 0.050));
  EXPECT_EQ(times("Thelen2003Muscle_Deprecated"), std::pair(0.010, 0.040));
  EXPECT_EQ(times("Millard2012EquilibriumMuscle"), std::pair(0.010, 0.040));
  EXPECT_EQ(times("DeGrooteFregly2016Muscle"), std::pair(0.015, 0.060));
  const Muscle millard = pendulum(muscle_of("Millard2012EquilibriumMuscle")).muscles.at(0);
  EXPECT_EQ(millard.parameters.fiber_damping, 0.1);
  EXPECT_TRUE(millard.enabled);
  EXPECT_FALSE(millard.parameters.rigid_tendon);
}

TEST(OsimMuscle, TakesWhatItsFileSays) {
  const Muscle m = pendulum(muscle_of("Thelen2003Muscle",
                                      "<appliesForce>false</appliesForce><max_isometric_force>750</max_isometric_force>"
                                      "<optimal_fiber_length>0.09</optimal_fiber_length><Flen>1.8</Flen>"
                                      "<tendon_slack_length>0</tendon_slack_length>"
                                      "<ignore_tendon_compliance>true</ignore_tendon_compliance>"
                                      "<ignore_activation_dynamics>true</ignore_activation_dynamics>"
                                      "<max_control>0.9</max_control>"))
                       .muscles.at(0);
  EXPECT_FALSE(m.enabled);
  EXPECT_EQ(m.parameters.musculotendon.max_isometric_force, 750.0);
  EXPECT_EQ(m.parameters.musculotendon.optimal_fiber_length, 0.09);
  EXPECT_EQ(m.parameters.musculotendon.tendon_slack_length, 0.0) << "with a rigid tendon it may be";
  EXPECT_TRUE(m.parameters.rigid_tendon && m.parameters.ignore_activation_dynamics);
  EXPECT_EQ(m.parameters.max_control, 0.9);
  EXPECT_EQ(std::get<ThelenCurves>(m.parameters.curves).Flen, 1.8);
}

TEST(OsimMuscle, HasPointsThatActInARangeOrMoveWithACoordinate) {
  const std::string conditional =
      "<ConditionalPathPoint name=\"c\"><socket_parent_frame>/ground</socket_parent_frame><location>0.05 0.05 0"
      "</location><socket_coordinate>/jointset/hinge/swing</socket_coordinate><range>1.5 -0.5</range>"
      "</ConditionalPathPoint>";
  const std::string moving =
      "<MovingPathPoint name=\"d\"><socket_parent_frame>/bodyset/rod</socket_parent_frame>"
      "<socket_x_coordinate>/jointset/hinge/swing</socket_x_coordinate>"
      "<x_location><LinearFunction><coefficients>2 0.5</coefficients></LinearFunction></x_location>"
      "<y_location><Constant><value>-0.05</value></Constant></y_location>"
      "<z_location><Constant><value>0</value></Constant></z_location></MovingPathPoint>";
  const std::size_t cut = kPoints.find("<PathPoint name=\"b\"");
  const Muscle m =
      pendulum(muscle_of("Thelen2003Muscle", "", kPoints.substr(0, cut) + conditional + moving + kPoints.substr(cut)))
          .muscles.at(0);
  ASSERT_EQ(m.points.size(), 4U);
  EXPECT_EQ(m.points[1].kind, PathPointKind::kConditional);
  EXPECT_EQ(m.points[1].coordinate, 0);
  EXPECT_EQ(m.points[1].low, -0.5) << "whichever way round";
  EXPECT_EQ(m.points[1].high, 1.5);
  EXPECT_EQ(m.points[2].kind, PathPointKind::kMoving);
  EXPECT_EQ(m.points[2].moving_coordinate[0], 0);
  EXPECT_NEAR(m.points[2].moving_location[0].evaluate(0.3).value, 2.0 * 0.3 + 0.5, 1e-14);
  EXPECT_NEAR(m.points[2].moving_location[1].evaluate(0.3).value, -0.05, 1e-15);
}

TEST(OsimMuscle, MayBeginOrEndWithAConditionalPointIfTwoOthersAreAlwaysThere) {
  const std::string conditional =
      "<ConditionalPathPoint name=\"c\"><socket_parent_frame>/ground</socket_parent_frame><location>0.05 0.05 0"
      "</location><socket_coordinate>/jointset/hinge/swing</socket_coordinate><range>-0.5 1.5</range>"
      "</ConditionalPathPoint>";
  const Muscle m = pendulum(muscle_of("Thelen2003Muscle", "", conditional + kPoints + conditional)).muscles.at(0);
  ASSERT_EQ(m.points.size(), 4U);
  EXPECT_EQ(m.points.front().kind, PathPointKind::kConditional);
  EXPECT_EQ(m.points.back().kind, PathPointKind::kConditional);
  const std::size_t cut = kPoints.find("<PathPoint name=\"b\"");
  EXPECT_THAT(refused(muscle_of("Thelen2003Muscle", "", kPoints.substr(0, cut) + conditional)),
              HasSubstr("PathPointSet: 1 of 2 points are not conditional; at least two must be"));
}

// Ranges count from one, the last point included; below one means "from the first" and "to the last".
TEST(OsimMuscle, WrapsOverPartOfItsPath) {
  const auto wrap = [](const std::string& range) {
    return pendulum(muscle_of("Thelen2003Muscle", "", kPoints,
                              "<PathWrap name=\"w\"><wrap_object>drum</wrap_object><method>axial</method><range>" +
                                  range + "</range></PathWrap>"))
        .muscles.at(0)
        .wraps.at(0);
  };
  const PathWrap some = wrap("1 2"), all = wrap("-1 -1");
  EXPECT_EQ(some.object, 0);
  EXPECT_EQ(some.method, EllipsoidMethod::kAxial);
  EXPECT_EQ(std::pair(some.first_point, some.last_point), std::pair(0, 1));
  EXPECT_EQ(std::pair(all.first_point, all.last_point), std::pair(0, -1));
  EXPECT_THAT(why([&] { static_cast<void>(wrap("1 3")); }), HasSubstr("beyond the 2 points"));
  EXPECT_THAT(why([&] { static_cast<void>(wrap("2 2")); }), HasSubstr("holds no two points"));
}

// The file's numbers are per degree; one newton metre a degree is 57.3 a radian.
TEST(OsimForces, LimitsAreInRadians) {
  const Model model = pendulum(
      "<CoordinateLimitForce name=\"stop\"><coordinate>swing</coordinate><upper_stiffness>2</upper_stiffness>"
      "<upper_limit>90</upper_limit><lower_stiffness>1</lower_stiffness><lower_limit>-45</lower_limit>"
      "<damping>0.5</damping><transition>10</transition></CoordinateLimitForce>");
  ASSERT_EQ(model.limit_forces.size(), 1U);
  const CoordinateLimitForce& f = model.limit_forces[0];
  EXPECT_NEAR(f.upper_stiffness, 2.0 * 180.0 / kPi, 1e-12);
  EXPECT_NEAR(f.upper_limit, kPi / 2.0, 1e-12);
  EXPECT_NEAR(f.lower_limit, -kPi / 4.0, 1e-12);
  EXPECT_NEAR(f.damping, 0.5 * 180.0 / kPi, 1e-12);
  EXPECT_NEAR(f.transition, kPi / 18.0, 1e-12);
}

TEST(OsimForces, ActuatorsMayHaveNoBoundAndAreOffWhereTheFileSaysSo) {
  const std::string actuator =
      "<CoordinateActuator name=\"motor\"><coordinate>swing</coordinate><optimal_force>5</optimal_force>"
      "<min_control>-Inf</min_control><max_control>3</max_control>";
  const Model on = pendulum(actuator + "</CoordinateActuator>");
  ASSERT_EQ(on.actuators.size(), 1U);
  EXPECT_EQ(on.actuators[0].optimal_force, 5.0);
  EXPECT_EQ(on.actuators[0].min_control, CoordinateActuator().min_control) << "as where it says nothing";
  EXPECT_EQ(on.actuators[0].max_control, 3.0);
  EXPECT_TRUE(pendulum(actuator + "<appliesForce>false</appliesForce></CoordinateActuator>").actuators.empty());
  // Without a control they do nothing.
  for (const char* type : {"TorqueActuator", "PointActuator", "BodyActuator", "PointToPointActuator"}) {
    const Model model = pendulum(fmt::format("<{} name=\"b\"/>", type));
    ASSERT_EQ(model.unsupported.size(), 1U) << type;
    EXPECT_FALSE(model.unsupported[0].changes_motion) << type;
  }
}

TEST(OsimMuscle, SchuttesHasItsCurvesAndFactors) {
  const std::string more =
      "<optimal_fiber_length>0.06</optimal_fiber_length><time_scale>0.2</time_scale><activation1>8</activation1>"
      "<activation2>2</activation2><damping>0.05</damping><max_contraction_velocity>10</max_contraction_velocity>"
      "<SimmSpline name=\"active_force_length_curve\"><x>0 0.5 1 1.5</x><y>0 0.6 1 0.6</y></SimmSpline>";
  const MuscleParameters p = pendulum(muscle_of("Schutte1993Muscle_Deprecated", more)).muscles.at(0).parameters;
  const auto* c = std::get_if<SchutteCurves>(&p.curves);
  ASSERT_NE(c, nullptr);
  EXPECT_EQ(c->damping, 0.05);
  EXPECT_NEAR(c->active.evaluate(0.5).value, 0.6, 1e-15);
  EXPECT_NEAR(c->tendon.evaluate(0.0103).value, 0.161, 1e-14) << "its class's own";
  EXPECT_FALSE(c->passive);
  EXPECT_NEAR(p.musculotendon.max_contraction_velocity, 5.0, 1e-15);
  EXPECT_NEAR(p.musculotendon.activation_time_constant, 0.02, 1e-15);
  EXPECT_NEAR(p.musculotendon.deactivation_time_constant, 0.1, 1e-15);
  // The name before 2012, curves among the defaults of the class.
  const Model old =
      OsimFile::parse(
          "<OpenSimDocument Version=\"20303\"><Model name=\"m\"><defaults><Schutte1993Muscle>"
          "<passive_force_length_curve><PiecewiseLinearFunction><x>0 1</x><y>0 2</y>"
          "</PiecewiseLinearFunction></passive_force_length_curve></Schutte1993Muscle></defaults><ForceSet>"
          "<objects>" +
              with_ground_points(muscle_of("Schutte1993Muscle")) + "</objects></ForceSet></Model></OpenSimDocument>",
          "old.osim")
          .model();
  const auto* before = std::get_if<SchutteCurves>(&old.muscles.at(0).parameters.curves);
  ASSERT_NE(before, nullptr);
  ASSERT_TRUE(before->passive);
  EXPECT_NEAR(before->passive->evaluate(0.5).value, 1.0, 1e-15);
}

TEST(OsimMuscle, AMovingPointMayStandInAnOffsetFrame) {
  const std::string moving =
      "<MovingPathPoint name=\"d\"><socket_parent_frame>tilted</socket_parent_frame>"
      "<socket_x_coordinate>swing</socket_x_coordinate><x_location><LinearFunction><coefficients>0.1 0.05"
      "</coefficients></LinearFunction></x_location><y_location><Constant><value>0</value></Constant></y_location>"
      "<z_location><Constant><value>0</value></Constant></z_location></MovingPathPoint>";
  const std::string text = muscle_of("Thelen2003Muscle", "", kPoints + moving);
  const Model model =
      pendulum(text +
               "<BushingForce name=\"frames\"><appliesForce>false</appliesForce><frames><PhysicalOffsetFrame "
               "name=\"tilted\"><socket_parent>/bodyset/rod</socket_parent><translation>0 -0.3 0</translation>"
               "<orientation>0 0 1.5707963267948966</orientation></PhysicalOffsetFrame></frames></BushingForce>");
  const Mechanism mechanism(model);
  const MusclePaths paths(model, mechanism);
  Kinematics<double> kinematics(mechanism);
  const double q = 0.4;
  update_positions(mechanism, &q, kinematics);
  const std::vector<Eigen::Vector3d> line = paths.polyline(kinematics, &q, 0);
  // The frame's x axis is the rod's y axis.
  const Eigen::Vector3d expected = kinematics.pose[1] * Eigen::Vector3d(0.0, -0.3 + 0.1 * q + 0.05, 0.0);
  EXPECT_LT((line.back() - expected).norm(), 1e-15);
}

TEST(OsimMuscle, MistakesAreNamedInOneLine) {
  const auto with = [](const char* more) { return refused(muscle_of("Thelen2003Muscle", more)); };
  EXPECT_THAT(with("<pennation_angle_at_optimal>1.6</pennation_angle_at_optimal>"),
              AllOf(HasSubstr("pendulum.osim"), HasSubstr("must be below pi/2")));
  EXPECT_THAT(with("<Flen>0.9</Flen>"), HasSubstr("Flen: 0.9 must be > 1"));
  EXPECT_THAT(with("<tendon_slack_length>0</tendon_slack_length>"), HasSubstr("0 needs a rigid tendon"));
  EXPECT_THAT(with("<min_control>0.9</min_control><max_control>0.5</max_control>"),
              HasSubstr("0.9 is above max_control 0.5"));
  EXPECT_THAT(with("<max_isometric_force>-1</max_isometric_force>"), HasSubstr("max_isometric_force"));
  EXPECT_THAT(refused(muscle_of("Millard2012EquilibriumMuscle",
                                "<ActiveForceLengthCurve name=\"c\"><min_norm_active_fiber_length>0.9"
                                "</min_norm_active_fiber_length></ActiveForceLengthCurve>")),
              HasSubstr("0 < minimum < transition < 1 < maximum"));
  EXPECT_THAT(refused(muscle_of("Thelen2003Muscle") + muscle_of("Thelen2003Muscle")),
              HasSubstr("a second muscle of this name"));
  EXPECT_THAT(refused(muscle_of("Thelen2003Muscle", "", kPoints.substr(0, kPoints.find("<PathPoint name=\"b\"")))),
              HasSubstr("1 points; a path has at least two"));
  EXPECT_THAT(refused(muscle_of("Thelen2003Muscle", "", kPoints,
                                "<PathWrap name=\"w\"><wrap_object>drun</wrap_object></PathWrap>")),
              AllOf(HasSubstr("there is no wrap object 'drun'"), HasSubstr("drum")));
  EXPECT_THAT(refused("<Thelen2003Muscle name=\"m\"/>"), HasSubstr("GeometryPath: missing"));
}

}  // namespace
}  // namespace veridyn::muscle
