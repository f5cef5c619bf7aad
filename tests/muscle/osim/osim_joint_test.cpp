// Joints of OpenSim models.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"
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
  refused("PinJoint", coordinates({"a"}) + "<reverse>true</reverse>", "reversed joints are not understood");
  refused("CustomJoint", coordinates({"q"}), "SpatialTransform: missing");
  const auto transform = [](const std::string& axes) {
    return coordinates({"q"}) + "<SpatialTransform>" + axes + "</SpatialTransform>";
  };
  refused("CustomJoint", transform(axis("rotation4", "q", 1.0)), "is none of rotation1 to rotation3");
  refused("CustomJoint", transform(with(axis("rotation1", "q", 1.0), "0 0 2", "0 0 0")), "has no direction");
  refused("CustomJoint", transform(axis("rotation1", "q p", 1.0)), "functions of several coordinates");
  EXPECT_THAT(joint_error(with(one_joint("PinJoint", ""), "/bodyset/link<", "/ground<")),
              HasSubstr("the ground cannot be the child of a joint"));
  EXPECT_THAT(joint_error(with(one_joint("PinJoint", ""), "/ground<", "/bodyset/link<")),
              HasSubstr("a joint cannot connect a body to itself"));
}

TEST(OsimReader, JointsThatGoRoundInACircleAreRefused) {
  // The humerus hangs on the forearm and the forearm on the humerus.
  const std::string text =
      with(std::string(builtin_models()[0].text), "<socket_parent>/ground<", "<socket_parent>/bodyset/forearm<");
  EXPECT_THAT(joint_error(text), HasSubstr("go round in a circle"));
  const std::string frames =
      with(std::string(builtin_models()[0].text), "<socket_parent>/ground<", "<socket_parent>shoulder_in_ground<");
  EXPECT_THAT(joint_error(frames), HasSubstr("circle"));
}

}  // namespace
}  // namespace veridyn::muscle
