// Frames of files: those of stations, and what scripts add among the components.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

using testing::HasSubstr;

/// A thigh on a hip whose child frame is `frame`, with stations and frames among the thigh's components.
Model thigh(const std::string& components, const std::string& frame) {
  return OsimFile::parse(fmt::format(R"(<OpenSimDocument Version="40500"><Model name="m"><BodySet><objects>
<Body name="thigh"><components>{}</components><mass>1</mass><inertia>1 1 1 0 0 0</inertia></Body></objects></BodySet>
<JointSet><objects><PinJoint name="hip"><socket_parent_frame>/ground</socket_parent_frame>
<socket_child_frame>{}</socket_child_frame><coordinates><Coordinate name="flexion"/></coordinates>
</PinJoint></objects></JointSet></Model></OpenSimDocument>)",
                                     components, frame),
                         "m.osim")
      .model();
}

std::string error_of(const std::string& components, const std::string& frame) {
  try {
    static_cast<void>(thigh(components, frame));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string station(const std::string& name, const std::string& location, const std::string& parent = "..") {
  return fmt::format(
      "<Station name=\"{}\"><socket_parent_frame>{}</socket_parent_frame><location>{}</location></Station>", name,
      parent, location);
}

const std::string kStations =
    station("head", "0.1 0.2 0.3") + station("knee", "0.1 -0.2 0.3") + station("side", "0.1 0 0.4");

std::string frame_of_stations(const std::string& more, const std::string& c = "../side") {
  return fmt::format(
      "<StationDefinedFrame name=\"anatomical\"><socket_point_a>../knee</socket_point_a><socket_point_b>../head"
      "</socket_point_b><socket_point_c>{}</socket_point_c><socket_origin_point>/bodyset/thigh/head"
      "</socket_origin_point>{}</StationDefinedFrame>",
      c, more);
}

TEST(OsimFrame, OfStationsHasItsAxesAlongTheirTriangle) {
  const auto placed = [](const std::string& axes) {
    const Model model = thigh(kStations + frame_of_stations(axes), "/bodyset/thigh/anatomical");
    EXPECT_TRUE(model.unsupported.empty());
    return model.joints[0].child_frame;
  };
  // From the knee to the head is y, across the triangle (y times z) is x.
  const Placement upright = placed("<ab_axis>+y</ab_axis><ab_x_ac_axis>+x</ab_x_ac_axis>");
  EXPECT_LT((upright.rotation - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_LT((upright.translation - Eigen::Vector3d(0.1, 0.2, 0.3)).norm(), 1e-15);
  Eigen::Matrix3d expected;  // by default x along, y across, z completes them
  expected << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  EXPECT_LT((placed("").rotation - expected).norm(), 1e-14);
  const Eigen::Matrix3d turned = placed("<ab_axis>-z</ab_axis><ab_x_ac_axis>y</ab_x_ac_axis>").rotation;
  EXPECT_LT((turned.col(2) + Eigen::Vector3d::UnitY()).norm(), 1e-14);
  EXPECT_LT((turned.col(1) - Eigen::Vector3d::UnitX()).norm(), 1e-14);
  EXPECT_NEAR(turned.determinant(), 1.0, 1e-14);
}

TEST(OsimFrame, OfStationsMayHoldAnOffsetFrame) {
  const Model model = thigh(kStations + frame_of_stations("<ab_axis>y</ab_axis><ab_x_ac_axis>x</ab_x_ac_axis>") +
                                "<PhysicalOffsetFrame name=\"beside\"><socket_parent>../anatomical</socket_parent>"
                                "<translation>1 2 3</translation></PhysicalOffsetFrame>",
                            "/bodyset/thigh/beside");
  EXPECT_LT((model.joints[0].child_frame.translation - Eigen::Vector3d(1.1, 2.2, 3.3)).norm(), 1e-14);
}

TEST(OsimFrame, OfStationsThatDetermineNoneIsRefusedInOneLine) {
  const auto expect = [](const std::string& components, const char* what) {
    EXPECT_THAT(error_of(components, "/bodyset/thigh/anatomical"),
                testing::AllOf(testing::StartsWith("m.osim:"), HasSubstr(what), testing::Not(HasSubstr("\n"))));
  };
  expect(frame_of_stations(""), "'anatomical': socket_point_a: there is no station '../knee'");
  expect(kStations + station("line", "0.1 0.7 0.3") + frame_of_stations("", "../line"), "its points are on one line");
  expect(kStations + station("floor", "1 1 1", "/ground") + frame_of_stations("", "../floor"), "of several bodies");
  expect(kStations + frame_of_stations("<ab_axis>w</ab_axis>"), "ab_axis: 'w' is none of");
  expect(kStations + frame_of_stations("<ab_axis>y</ab_axis>"), "ab_x_ac_axis: is along the same axis");
  expect(kStations + station("own", "0 0 0", "/bodyset/thigh/anatomical") + frame_of_stations("", "../own"),
         "go round in a circle");
}

}  // namespace
}  // namespace veridyn::muscle
