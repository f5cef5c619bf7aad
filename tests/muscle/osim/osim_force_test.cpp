// Forces that need no control, as files have them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

using testing::HasSubstr;

/// A body on a pin, contact geometries, and forces.
Model with_forces(const std::string& forces) {
  return OsimFile::parse(fmt::format(R"(<OpenSimDocument Version="40000"><Model name="m"><BodySet><objects>
<Body name="bar"><mass>1</mass><inertia>1 1 1 0 0 0</inertia></Body></objects></BodySet>
<JointSet><objects><PinJoint name="pin"><socket_parent_frame>/ground</socket_parent_frame>
<socket_child_frame>/bodyset/bar</socket_child_frame><coordinates><Coordinate name="angle"/></coordinates>
</PinJoint></objects></JointSet>
<ContactGeometrySet><objects>
<ContactHalfSpace name="floor"><socket_frame>/ground</socket_frame><orientation>0 0 -1.5707963267948966</orientation>
</ContactHalfSpace>
<ContactSphere name="heel"><socket_frame>/bodyset/bar</socket_frame><location>0.1 -0.2 0</location>
<radius>0.03</radius></ContactSphere><ContactMesh name="sole"><socket_frame>/bodyset/bar</socket_frame></ContactMesh>
</objects></ContactGeometrySet>
<ForceSet><objects>{}</objects></ForceSet></Model></OpenSimDocument>)",
                                     forces),
                         "m.osim")
      .model();
}

std::string error_of(const std::string& forces) {
  try {
    static_cast<void>(with_forces(forces));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

constexpr const char* kPath =
    "<GeometryPath><PathPointSet><objects><PathPoint name=\"a\"><socket_parent_frame>/ground</socket_parent_frame>"
    "<location>0.1 0.2 0</location></PathPoint><PathPoint name=\"b\"><socket_parent_frame>/bodyset/bar"
    "</socket_parent_frame><location>0 -0.3 0</location></PathPoint></objects></PathPointSet></GeometryPath>";

TEST(OsimForce, ASpringOnACoordinateIsRead) {
  const Model model = with_forces(
      "<SpringGeneralizedForce name=\"s\"><coordinate>angle</coordinate><stiffness>5</stiffness>"
      "<rest_length>0.2</rest_length><viscosity>0.3</viscosity></SpringGeneralizedForce>");
  ASSERT_EQ(model.coordinate_springs.size(), 1u);
  EXPECT_EQ(model.coordinate_springs[0].coordinate, 0);
  EXPECT_DOUBLE_EQ(model.coordinate_springs[0].stiffness, 5.0);
  EXPECT_DOUBLE_EQ(model.coordinate_springs[0].rest_length, 0.2);
  EXPECT_DOUBLE_EQ(model.coordinate_springs[0].viscosity, 0.3);
  EXPECT_TRUE(model.unsupported.empty());
}

TEST(OsimForce, ABushingIsReadWithItsFrames) {
  const Model model = with_forces(
      "<BushingForce name=\"b\"><socket_frame1>/ground</socket_frame1><socket_frame2>bar_offset</socket_frame2>"
      "<frames><PhysicalOffsetFrame name=\"bar_offset\"><socket_parent>/bodyset/bar</socket_parent>"
      "<translation>0 0.1 0</translation></PhysicalOffsetFrame></frames>"
      "<rotational_stiffness>1 2 3</rotational_stiffness><translational_damping>4 5 6</translational_damping>"
      "</BushingForce>");
  ASSERT_EQ(model.body_forces.bushings.size(), 1u);
  const Bushing& b = model.body_forces.bushings[0];
  EXPECT_EQ(b.body_1, 0);
  EXPECT_EQ(b.body_2, 1);
  EXPECT_EQ(b.frame_2.translation, Eigen::Vector3d(0.0, 0.1, 0.0));
  EXPECT_EQ(b.resistance[1].evaluate(0.5).value, 1.0);
  EXPECT_EQ(b.resistance[4].evaluate(0.5).value, 0.0);
  EXPECT_EQ(b.translational_damping, Eigen::Vector3d(4, 5, 6));
  EXPECT_THAT(error_of("<BushingForce name=\"b\"><socket_frame1>/ground</socket_frame1><socket_frame2>bar"
                       "</socket_frame2><rotational_stiffness>-1 0 0</rotational_stiffness></BushingForce>"),
              HasSubstr("BushingForce 'b': rotational_stiffness"));
}

TEST(OsimForce, ABushingOfFunctionsIsReadAndOneWithDampersIsWarnedOf) {
  const std::string bushing =
      "<FunctionBasedBushingForce name=\"disc\"><socket_frame1>/ground</socket_frame1><socket_frame2>/bodyset/bar"
      "</socket_frame2><SimmSpline name=\"m_z_theta_z_function\"><x>-1 0 1</x><y>-8 0 4</y></SimmSpline>"
      "<f_x_delta_x_function><LinearFunction><coefficients>7 1</coefficients></LinearFunction></f_x_delta_x_function>"
      "{}</FunctionBasedBushingForce>";
  const Model model = with_forces(fmt::format(fmt::runtime(bushing), ""));
  EXPECT_TRUE(model.unsupported.empty());
  EXPECT_TRUE(model.warnings.empty());
  ASSERT_EQ(model.body_forces.bushings.size(), 1U);
  const Bushing& b = model.body_forces.bushings[0];
  EXPECT_DOUBLE_EQ(b.resistance[2].evaluate(-1.0).value, -8.0);
  EXPECT_DOUBLE_EQ(b.resistance[3].evaluate(2.0).value, 15.0);
  EXPECT_EQ(b.resistance[0].evaluate(0.3).value, 0.0);
  const Model damped =
      with_forces(fmt::format(fmt::runtime(bushing), "<rotational_damping>0 0 2</rotational_damping>"));
  ASSERT_EQ(damped.warnings.size(), 1U);
  EXPECT_THAT(damped.warnings[0], HasSubstr("'disc': its damping counts here; OpenSim reads it and applies none"));
}

TEST(OsimForce, ABushingOfFormatsBeforeFourNamesItsBodies) {
  const Model model = with_forces(
      "<BushingForce name=\"b\"><body_1>ground</body_1><body_2>bar</body_2><location_body_2>0 0.2 0"
      "</location_body_2></BushingForce>");
  ASSERT_EQ(model.body_forces.bushings.size(), 1u);
  EXPECT_EQ(model.body_forces.bushings[0].body_2, 1);
  EXPECT_EQ(model.body_forces.bushings[0].frame_2.translation, Eigen::Vector3d(0.0, 0.2, 0.0));
}

TEST(OsimForce, ContactOfASphereWithAHalfSpaceIsReadAndMeshesAreNamed) {
  const auto hunt_crossley = [](const std::string& geometry) {
    return "<HuntCrossleyForce name=\"c\"><HuntCrossleyForce::ContactParametersSet "
           "name=\"contact_parameters\"><objects>"
           "<HuntCrossleyForce::ContactParameters><geometry>" +
           geometry +
           "</geometry><stiffness>1e6</stiffness><dissipation>2</dissipation><static_friction>0.8</static_friction>"
           "<dynamic_friction>0.4</dynamic_friction><viscous_friction>0.1</viscous_friction>"
           "</HuntCrossleyForce::ContactParameters></objects></HuntCrossleyForce::ContactParametersSet>"
           "<transition_velocity>0.13</transition_velocity></HuntCrossleyForce>";
  };
  const Model model = with_forces(hunt_crossley("floor heel"));
  ASSERT_EQ(model.body_forces.contacts.size(), 1u);
  const SphereContact& c = model.body_forces.contacts[0];
  EXPECT_EQ(c.sphere_body, 1);
  EXPECT_EQ(c.plane_body, 0);
  EXPECT_EQ(c.center, Eigen::Vector3d(0.1, -0.2, 0.0));
  EXPECT_DOUBLE_EQ(c.radius, 0.03);
  EXPECT_NEAR(c.half_stiffness, 1e4 / 2.0, 1e-9);  // (1e6)^(2/3)/2
  EXPECT_DOUBLE_EQ(c.dissipation, 2.0);
  EXPECT_DOUBLE_EQ(c.static_friction, 0.8);
  EXPECT_DOUBLE_EQ(c.transition_velocity, 0.13);
  EXPECT_FALSE(c.smooth);
  // The normal is up.
  EXPECT_NEAR((c.plane.rotation.col(0) + Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-15);
  const Model mesh = with_forces(hunt_crossley("floor sole"));
  ASSERT_EQ(mesh.unsupported.size(), 1u);
  EXPECT_EQ(mesh.unsupported[0].element, "HuntCrossleyForce");
  EXPECT_TRUE(mesh.unsupported[0].changes_motion);
  EXPECT_THAT(error_of(hunt_crossley("floor toe")), HasSubstr("there is no contact geometry 'toe'"));
  const Model smooth = with_forces(
      "<SmoothSphereHalfSpaceForce name=\"c\"><socket_sphere>heel</socket_sphere><socket_half_space>floor"
      "</socket_half_space><stiffness>1e6</stiffness><hertz_smoothing>250</hertz_smoothing>"
      "</SmoothSphereHalfSpaceForce>");
  ASSERT_EQ(smooth.body_forces.contacts.size(), 1u);
  EXPECT_TRUE(smooth.body_forces.contacts[0].smooth);
  EXPECT_DOUBLE_EQ(smooth.body_forces.contacts[0].hertz_smoothing, 250.0);
}

TEST(OsimForce, PassivePathsAreRead) {
  const Model model = with_forces(fmt::format(
      "<PathSpring name=\"p\">{0}<resting_length>0.3</resting_length><stiffness>100</stiffness><dissipation>0.2"
      "</dissipation></PathSpring><Ligament name=\"l\">{0}<resting_length>0.4</resting_length><pcsa_force>50"
      "</pcsa_force><SimmSpline name=\"force_length_curve\"><x>-1 0 1 2</x><y>0 0 1 2</y></SimmSpline></Ligament>"
      "<PathActuator name=\"a\">{0}<optimal_force>10</optimal_force></PathActuator>"
      "<PointToPointSpring name=\"s\"><socket_body1>/ground</socket_body1><socket_body2>/bodyset/bar</socket_body2>"
      "<point2>0 1 0</point2><stiffness>7</stiffness><rest_length>0.1</rest_length></PointToPointSpring>",
      kPath));
  ASSERT_EQ(model.passive_paths.size(), 2u);
  EXPECT_EQ(model.passive_paths[0].points.size(), 2u);
  EXPECT_DOUBLE_EQ(std::get<PathSpringLaw>(model.passive_paths[0].law).stiffness, 100.0);
  EXPECT_DOUBLE_EQ(std::get<LigamentLaw>(model.passive_paths[1].law).pcsa_force, 50.0);
  ASSERT_EQ(model.body_forces.springs.size(), 1u);
  EXPECT_EQ(model.body_forces.springs[0].point_2, Eigen::Vector3d(0.0, 1.0, 0.0));
  // Without a control it pulls nothing: named, and no obstacle to a simulation.
  ASSERT_EQ(model.unsupported.size(), 1u);
  EXPECT_EQ(model.unsupported[0].element, "PathActuator");
  EXPECT_FALSE(model.unsupported[0].changes_motion);
}

TEST(OsimForce, ABlankevoortLigamentIsReadWithItsDefaults) {
  const Model model = with_forces(
      fmt::format("<Blankevoort1991Ligament name=\"acl\">{}<linear_stiffness>5000</linear_stiffness><slack_length>0.03"
                  "</slack_length></Blankevoort1991Ligament>",
                  kPath));
  ASSERT_EQ(model.passive_paths.size(), 1u);
  EXPECT_TRUE(model.unsupported.empty());
  const auto& law = std::get<BlankevoortLaw>(model.passive_paths[0].law);
  EXPECT_DOUBLE_EQ(law.linear_stiffness, 5000.0);
  EXPECT_DOUBLE_EQ(law.slack_length, 0.03);
  EXPECT_DOUBLE_EQ(law.transition_strain, 0.06);
  EXPECT_DOUBLE_EQ(law.damping_coefficient, 0.003);
  EXPECT_THAT(error_of(fmt::format("<Blankevoort1991Ligament name=\"acl\">{}</Blankevoort1991Ligament>", kPath)),
              HasSubstr("slack_length"));
}

TEST(OsimForce, FormulasAreReadWithTheirVariables) {
  const Model model = with_forces(
      "<ExpressionBasedCoordinateForce name=\"c\"><coordinate>angle</coordinate><expression> -10*q - 0.5*qdot^3 "
      "</expression></ExpressionBasedCoordinateForce>"
      "<ExpressionBasedPointToPointForce name=\"p\"><socket_body1>/ground</socket_body1><socket_body2>/bodyset/bar"
      "</socket_body2><point2>0 1 0</point2><expression>3/d^2</expression></ExpressionBasedPointToPointForce>"
      "<ExpressionBasedBushingForce name=\"b\"><socket_frame1>/ground</socket_frame1><socket_frame2>/bodyset/bar"
      "</socket_frame2><Mz_expression>2*theta_z + delta_x</Mz_expression><rotational_damping>1 2 3"
      "</rotational_damping></ExpressionBasedBushingForce>");
  EXPECT_TRUE(model.unsupported.empty());
  const ExpressionForces& f = model.expression_forces;
  ASSERT_EQ(f.coordinates.size(), 1U);
  EXPECT_NEAR(f.coordinates[0].force(std::array{0.2, 2.0}), -6.0, 1e-15);
  ASSERT_EQ(f.points.size(), 1U);
  EXPECT_EQ(f.points[0].body_2, 1);
  EXPECT_EQ(f.points[0].point_2, Eigen::Vector3d::UnitY());
  EXPECT_NEAR(f.points[0].force(std::array{2.0, 0.0}), 0.75, 1e-15);
  ASSERT_EQ(f.bushings.size(), 1U);
  EXPECT_EQ(f.bushings[0].bushing.rotational_damping, Eigen::Vector3d(1.0, 2.0, 3.0));
  ASSERT_EQ(f.bushings[0].resistance.size(), 6U);
  const std::array deflection{0.0, 0.0, 0.3, 0.1, 0.0, 0.0};
  EXPECT_NEAR(f.bushings[0].resistance[2](deflection), 0.7, 1e-15);
  EXPECT_EQ(f.bushings[0].resistance[0](deflection), 0.0);
  EXPECT_THAT(error_of("<ExpressionBasedCoordinateForce name=\"c\"><coordinate>angle</coordinate><expression>-10*x"
                       "</expression></ExpressionBasedCoordinateForce>"),
              testing::AllOf(HasSubstr("m.osim:"), HasSubstr("expression: '-10*x'")));
}

}  // namespace
}  // namespace veridyn::muscle
