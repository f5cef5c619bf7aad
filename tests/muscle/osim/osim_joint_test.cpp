// Joints of OpenSim models.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/dynamics/mechanism.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A body on the ground by one joint.
std::string one_joint(const std::string& type, const std::string& content) {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<OpenSimDocument Version=\"40000\"><Model name=\"m\">\n"
      "<BodySet><objects><Body name=\"link\"><mass>1</mass><inertia>1 1 1 0 0 0</inertia></Body></objects></BodySet>\n"
      "<JointSet><objects><{0} name=\"joint\"><socket_parent_frame>/ground</socket_parent_frame>"
      "<socket_child_frame>/bodyset/link</socket_child_frame>\n{1}</{0}></objects></JointSet>\n"
      "</Model></OpenSimDocument>\n",
      type, content);
}
std::string coordinates(const std::vector<std::string>& names) {
  std::string text = "<coordinates>";
  for (const std::string& name : names) text += "<Coordinate name=\"" + name + "\"/>";
  return text + "</coordinates>";
}
std::string axis(const std::string& name, const std::string& coordinate, double slope) {
  return fmt::format(
      "<TransformAxis name=\"{}\"><coordinates>{}</coordinates><axis>0 0 2</axis><LinearFunction "
      "name=\"function\"><coefficients>{} 0</coefficients></LinearFunction></TransformAxis>",
      name, coordinate, slope);
}
Model read_joint(const std::string& type, const std::string& content) {
  return OsimFile::parse(one_joint(type, content), "joint.osim").model();
}
std::string joint_error(const std::string& text) {
  try {
    static_cast<void>(OsimFile::parse(text, "joint.osim"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}
std::string with(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

TEST(OsimJoint, PlainOnesMoveAboutAndAlongTheAxesOfTheirTypes) {
  const Model pin = read_joint("PinJoint", coordinates({"angle"}));
  ASSERT_EQ(pin.coordinates.size(), 1U);
  EXPECT_EQ(pin.coordinates[0].motion, CoordinateMotion::kRotational);
  EXPECT_EQ(pin.joints[0].rotation[2].coordinate, 0);
  EXPECT_EQ(pin.joints[0].rotation[2].axis, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(pin.joints[0].rotation[0].coordinate, -1);
  const Model slider = read_joint("SliderJoint", coordinates({"shift"}));
  EXPECT_EQ(slider.coordinates[0].motion, CoordinateMotion::kTranslational);
  EXPECT_EQ(slider.joints[0].translation[0].coordinate, 0);
  EXPECT_EQ(read_joint("WeldJoint", "").coordinates.size(), 0U);
}

TEST(OsimJoint, CoordinatesThatTheFileLeavesOutAreOpenSimsOwn) {
  const Model pin = read_joint("PinJoint", "");
  ASSERT_EQ(pin.coordinates.size(), 1U);
  EXPECT_EQ(pin.coordinates[0].name, "joint_coord_0");
  EXPECT_EQ(pin.coordinates[0].motion, CoordinateMotion::kRotational);
}

TEST(OsimJoint, ACoordinateIsAnAngleWhereOneAxisTurnsByItself) {
  const auto motion = [](const std::string& axes) {
    return read_joint("CustomJoint", coordinates({"q"}) + "<SpatialTransform>" + axes + "</SpatialTransform>")
        .coordinates[0]
        .motion;
  };
  EXPECT_EQ(motion(axis("rotation1", "q", 1.0)), CoordinateMotion::kRotational);
  EXPECT_EQ(motion(axis("rotation1", "q", -1.0)), CoordinateMotion::kRotational);
  EXPECT_EQ(motion(axis("translation2", "q", 1.0)), CoordinateMotion::kTranslational);
  EXPECT_EQ(motion(axis("rotation1", "q", 0.5)), CoordinateMotion::kCoupled);
  // A knee slides as it turns.
  EXPECT_EQ(motion(axis("rotation1", "q", 1.0) + axis("translation2", "q", 0.02)), CoordinateMotion::kRotational);
  const Model custom = read_joint(
      "CustomJoint", coordinates({"q"}) + "<SpatialTransform>" + axis("rotation1", "q", 1.0) + "</SpatialTransform>");
  EXPECT_EQ(custom.joints[0].rotation[0].axis, Eigen::Vector3d::UnitZ()) << "of length one";
}

TEST(OsimJoint, MistakesAreNamedWithTheJoint) {
  const auto refused = [](const std::string& type, const std::string& content, const std::string& what) {
    EXPECT_THAT(joint_error(one_joint(type, content)), AllOf(HasSubstr("joint.osim:"), HasSubstr(what)));
  };
  refused("PinJoint", coordinates({"a", "b"}), "2 where a PinJoint has 1");
  refused("EllipsoidJoint", coordinates({"a", "b", "c"}), "radii_x_y_z: all three radii must be > 0");
  refused("ScapulothoracicJoint", coordinates({"a", "b", "c", "d"}), "thoracic_ellipsoid_radii_x_y_z");
  refused("BallAndSocketJoint", "", "joints of this type are not understood");
  refused("CustomJoint", coordinates({"q"}), "SpatialTransform: missing");
  const auto transform = [](const std::string& axes) {
    return coordinates({"q"}) + "<SpatialTransform>" + axes + "</SpatialTransform>";
  };
  refused("CustomJoint", transform(axis("rotation4", "q", 1.0)), "is none of rotation1 to rotation3");
  refused("CustomJoint", transform(with(axis("rotation1", "q", 1.0), "0 0 2", "0 0 0")), "has no direction");
  refused("CustomJoint", transform(axis("rotation1", "q p", 1.0)), "coordinates: there is no coordinate 'p'");
  refused("CustomJoint", transform(axis("rotation1", "q q", 1.0)), "coordinates: 'q' stands there twice");
  EXPECT_THAT(joint_error(with(one_joint("PinJoint", ""), "/ground<", "/bodyset/link<")),
              HasSubstr("a joint cannot connect a body to itself"));
}

Pose<double> pose_of(const Model& model, const Eigen::VectorXd& q, const char* body) {
  const Mechanism mechanism(model);
  Kinematics<double> kinematics(mechanism);
  update_positions(mechanism, q.data(), kinematics);
  return body_pose(mechanism, kinematics, model.body(body));
}

// A knee that slides with flexion and varus together.
TEST(OsimJoint, AxesMayMoveWithSeveralCoordinates) {
  const std::string slide =
      "<TransformAxis name=\"translation2\"><coordinates>flexion varus</coordinates><axis>0 1 0</axis>"
      "<MultivariatePolynomialFunction name=\"function\"><coefficients>0.1 0.2 0.3 -0.4 0.5 -0.6</coefficients>"
      "<dimension>2</dimension><order>2</order></MultivariatePolynomialFunction></TransformAxis>";
  const std::string twist =
      "<TransformAxis name=\"rotation2\"><coordinates>varus flexion</coordinates><axis>0 1 0</axis><function>"
      "<LinearFunction><coefficients>0.5 0.25 0.125</coefficients></LinearFunction></function></TransformAxis>";
  const Model model =
      read_joint("CustomJoint", coordinates({"flexion", "varus"}) + "<SpatialTransform>" +
                                    axis("rotation1", "flexion", 1.0) + twist + slide + "</SpatialTransform>");
  EXPECT_THAT(model.joints[0].translation[1].several, testing::ElementsAre(0, 1));
  EXPECT_THAT(model.joints[0].rotation[1].several, testing::ElementsAre(1, 0));
  EXPECT_EQ(model.coordinates[1].motion, CoordinateMotion::kCoupled);
  const double f = 0.3, v = -0.2;
  const Pose<double> pose = pose_of(model, Eigen::Vector2d(f, v), "link");
  EXPECT_NEAR(pose.position.y(), 0.1 + 0.2 * v + 0.3 * v * v - 0.4 * f + 0.5 * f * v - 0.6 * f * f, 1e-15);
  const Eigen::Matrix3d expected = (Eigen::AngleAxisd(f, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(0.5 * v + 0.25 * f + 0.125, Eigen::Vector3d::UnitY()))
                                       .toRotationMatrix();
  EXPECT_LT((pose.rotation - expected).norm(), 1e-14);
}

TEST(OsimJoint, ReversedOnesGiveTheParentInTheChild) {
  const std::string frames =
      "<frames><PhysicalOffsetFrame name=\"up\"><socket_parent>/ground</socket_parent><translation>1 2 3</translation>"
      "<orientation>0.4 0 0</orientation></PhysicalOffsetFrame></frames>";
  const auto model = [&](const char* reverse) {
    return OsimFile::parse(
               with(one_joint("PlanarJoint", coordinates({"a", "x", "y"}) + reverse + frames), "/ground<", "up<"),
               "m.osim")
        .model();
  };
  const Model forward = model(""), reversed = model("<reverse>true</reverse>");
  EXPECT_TRUE(reversed.joints[0].reversed);
  const Eigen::Vector3d q(0.7, 0.2, -0.5);
  const Pose<double> there = pose_of(forward, q, "link"), back = pose_of(reversed, q, "link");
  // From the joint's frame, one is the inverse of the other.
  const Placement up = forward.joints[0].parent_frame;
  const Placement a = up.inverse() * Placement{there.rotation, there.position},
                  b = up.inverse() * Placement{back.rotation, back.position}, product = a * b;
  EXPECT_GT((a.rotation - b.rotation).norm(), 0.5);
  EXPECT_LT((product.rotation - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_LT(product.translation.norm(), 1e-14);
}

TEST(OsimJoint, AJointWhoseChildIsNearerToTheGroundIsTurnedRound) {
  const std::string text = one_joint("PinJoint", coordinates({"a"}));
  std::string turned = with(with(text, "/ground<", "X<"), "/bodyset/link<", "/ground<");
  turned = with(turned, "X<", "/bodyset/link<");
  const Model forward = OsimFile::parse(text, "m.osim").model(), model = OsimFile::parse(turned, "m.osim").model();
  EXPECT_EQ(model.joints[0].parent, 0);
  EXPECT_TRUE(model.joints[0].reversed);
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.3);
  EXPECT_LT((pose_of(model, q, "link").rotation.transpose() - pose_of(forward, q, "link").rotation).norm(), 1e-15);
}

TEST(OsimJoint, AnEllipsoidJointMovesOverItsEllipsoid) {
  const Model model = read_joint("EllipsoidJoint", coordinates({"a", "b", "c"}) + "<radii_x_y_z>1 2 3</radii_x_y_z>");
  const Pose<double> pose = pose_of(model, Eigen::Vector3d(0.4, -0.3, 0.9), "link");
  EXPECT_LT((pose.rotation - body_fixed_xyz({0.4, -0.3, 0.9})).norm(), 1e-14);
  EXPECT_LT((pose.position - pose.rotation.col(2).cwiseProduct(Eigen::Vector3d(1.0, 2.0, 3.0))).norm(), 1e-14);
}

TEST(OsimJoint, AScapulaGlidesOverTheThoraxAndTiltsAboutItsWingingAxis) {
  const Model model = read_joint(
      "ScapulothoracicJoint",
      coordinates({"abduction", "elevation", "upward", "winging"}) +
          "<thoracic_ellipsoid_radii_x_y_z>0.07 0.15 0.08</thoracic_ellipsoid_radii_x_y_z><scapula_winging_axis_origin>"
          "-0.05 "
          "0.01</scapula_winging_axis_origin><scapula_winging_axis_direction>0.3</scapula_winging_axis_direction>");
  ASSERT_EQ(model.coordinates.size(), 4U);
  for (const Coordinate& c : model.coordinates) EXPECT_EQ(model.joints[c.joint].name, "joint") << c.name;
  const Eigen::Vector4d q(0.3, -0.2, 0.5, 0.15);
  const Pose<double> pose = pose_of(model, q, "link");
  // The ellipsoid's frame is turned by 90 deg about z and back again; its radii are those of the thorax.
  const Eigen::Matrix3d turn = body_fixed_xyz({0.0, 0.0, 0.5 * kPi}), E = body_fixed_xyz({0.3, -0.2, 0.5});
  const Eigen::Matrix3d S = turn * E * turn.transpose();
  const Eigen::Vector3d surface = (turn * E.col(2)).cwiseProduct(Eigen::Vector3d(0.07, 0.15, 0.08));
  const Eigen::Matrix3d winging =
      Eigen::AngleAxisd(0.15, Eigen::Vector3d(-std::sin(0.3), std::cos(0.3), 0.0)).toRotationMatrix();
  const Eigen::Vector3d origin(-0.05, 0.01, 0.0);
  EXPECT_LT((pose.rotation - S * winging).norm(), 1e-14);
  EXPECT_LT((pose.position - (surface + S * (origin - winging * origin))).norm(), 1e-14);
}

TEST(OsimJoint, AJointThatClosesALoopSplitsItsBody) {
  const std::string second =
      "<PinJoint name=\"again\"><socket_parent_frame>/ground</socket_parent_frame><socket_child_frame>/bodyset/link"
      "</socket_child_frame></PinJoint>";
  const Model model =
      OsimFile::parse(with(one_joint("PinJoint", ""), "</objects></JointSet>", second + "</objects></JointSet>"),
                      "m.osim")
          .model();
  ASSERT_EQ(model.bodies.size(), 3U);
  EXPECT_EQ(model.bodies[1].mass, 0.5);
  EXPECT_EQ(model.bodies[2].mass, 0.5);
  ASSERT_EQ(model.loops.size(), 1U);
  EXPECT_EQ(model.loops[0].kind, LoopKind::kWeld);
  EXPECT_EQ(model.joints[1].child, 2);
  EXPECT_THAT(model.warnings, testing::Contains(HasSubstr("joint 'again' closes a loop: body 'link' is split")));
  EXPECT_EQ(Mechanism(model).links(), 3);
}

TEST(OsimReader, JointsThatGoRoundInACircleAreRefused) {
  // The humerus hangs on the forearm and the forearm on the humerus.
  const std::string text =
      with(std::string(builtin_models()[0].text), "<socket_parent>/ground<", "<socket_parent>/bodyset/forearm<");
  EXPECT_THAT(joint_error(text), HasSubstr("lead to other bodies, not to the ground"));
  const std::string frames =
      with(std::string(builtin_models()[0].text), "<socket_parent>/ground<", "<socket_parent>shoulder_in_ground<");
  EXPECT_THAT(joint_error(frames), HasSubstr("circle"));
}

TEST(OsimJoint, ACoordinateThatAConstantPrescribesIsHeldAndAMotionOverTimeIsNamed) {
  const auto pin = [](const std::string& function, const std::string& flags = "<prescribed>true</prescribed>") {
    return read_joint("PinJoint", "<coordinates><Coordinate name=\"angle\"><default_value>0.1</default_value>" + flags +
                                      "<prescribed_function>" + function + "</prescribed_function></Coordinate>" +
                                      "</coordinates>");
  };
  const Model held = pin("<Constant><value>0.4</value></Constant>");
  EXPECT_TRUE(held.coordinates[0].locked);
  EXPECT_EQ(held.coordinates[0].default_value, 0.4);
  ASSERT_EQ(held.warnings.size(), 1U);
  EXPECT_THAT(held.warnings[0], HasSubstr("Coordinate 'angle': its prescribed_function holds it at 0.4"));
  const std::string line = "<LinearFunction><coefficients>1 0</coefficients></LinearFunction>";
  const Model moving = pin(line);
  ASSERT_EQ(moving.unsupported.size(), 1U);
  EXPECT_EQ(moving.unsupported[0].element, "prescribed_function");
  EXPECT_EQ(moving.unsupported[0].name, "angle");
  EXPECT_TRUE(moving.unsupported[0].changes_motion);
  for (const char* flags : {"<prescribed>false</prescribed>", "<prescribed>true</prescribed><locked>true</locked>"}) {
    const Model other = pin(line, flags);
    EXPECT_TRUE(other.unsupported.empty());
    EXPECT_EQ(other.coordinates[0].default_value, 0.1);
  }
}

}  // namespace
}  // namespace veridyn::muscle
