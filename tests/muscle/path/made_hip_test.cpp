// Moment arms where no model at hand has them tested: cylinders whose ends paths pass, and objects that cross.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "tests/muscle/path/believable_arms.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

std::string made_axis(int number, const char* coordinate, const char* direction) {
  return fmt::format(
      "<TransformAxis name=\"rotation{}\"><coordinates>{}</coordinates><axis>{}</axis><LinearFunction "
      "name=\"function\">"
      "<coefficients>1 0</coefficients></LinearFunction></TransformAxis>",
      number, coordinate, direction);
}

/// 40 muscles from a pelvis that does not move to a thigh on three angles, each over a cylinder of the pelvis of 40 to
/// 100 mm at a random place and angle behind the joint; with `two` over one of the thigh as well, which often crosses
/// it.
Model made_hip(bool two) {
  std::mt19937 random(7);
  const auto between = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967295.0;
  };
  std::string pelvis, thigh, muscles;
  for (int i = 0; i < 40; ++i) {
    const double radius = between(0.02, 0.04), length = between(0.04, 0.1);
    const double x = between(-0.06, -0.02), y = between(-0.05, 0.02), z = between(-0.01, 0.03);
    const double a = between(-0.5, 0.5), b = between(-0.5, 0.5), c = between(-0.5, 0.5);
    const char* quadrant = between(0.0, 3.0) < 1.0 ? "all" : "-x";
    const auto cylinder = [&](const char* name, double height) {
      return fmt::format(
          "<WrapCylinder name=\"{}{}\"><xyz_body_rotation>{} {} {}</xyz_body_rotation><translation>{} {} "
          "{}</translation>"
          "<quadrant>{}</quadrant><radius>{}</radius><length>{}</length></WrapCylinder>",
          name, i, a, b, c, x, height, z, quadrant, radius, length);
    };
    pelvis += cylinder("p", y);
    thigh += cylinder("t", 1.5 * y);
    const std::string second =
        two ? fmt::format("<PathWrap name=\"second\"><wrap_object>t{}</wrap_object></PathWrap>", i) : "";
    const double px = between(-0.14, -0.09), py = between(0.0, 0.1), pz = between(-0.04, 0.05);
    const double tx = between(-0.05, 0.0), ty = between(-0.12, -0.05), tz = between(0.0, 0.04);
    muscles += fmt::format(
        "<Thelen2003Muscle name=\"m{0}\"><GeometryPath><PathPointSet><objects><PathPoint name=\"a\">"
        "<socket_parent_frame>/ground</socket_parent_frame><location>{1} {2} {3}</location></PathPoint>"
        "<PathPoint name=\"b\"><socket_parent_frame>/bodyset/thigh</socket_parent_frame><location>{4} {5} "
        "{6}</location>"
        "</PathPoint></objects></PathPointSet><PathWrapSet><objects><PathWrap name=\"first\"><wrap_object>p{0}"
        "</wrap_object></PathWrap>{7}</objects></PathWrapSet></GeometryPath></Thelen2003Muscle>",
        i, px, py, pz, tx, ty, tz, second);
  }
  return OsimFile::parse(
             fmt::format(
                 "<OpenSimDocument Version=\"40000\"><Model name=\"hip\"><Ground name=\"ground\"><WrapObjectSet>"
                 "<objects>{}</objects></WrapObjectSet></Ground><BodySet><objects><Body name=\"thigh\">"
                 "<WrapObjectSet><objects>{}</objects></WrapObjectSet><mass>8</mass>"
                 "<inertia>0.1 0.03 0.1 0 0 0</inertia></Body></objects></BodySet><JointSet><objects>"
                 "<CustomJoint name=\"hip\"><socket_parent_frame>/ground</socket_parent_frame>"
                 "<socket_child_frame>/bodyset/thigh</socket_child_frame><coordinates>"
                 "<Coordinate name=\"flexion\"><range>-0.52 2.09</range></Coordinate>"
                 "<Coordinate name=\"adduction\"><range>-0.87 0.52</range></Coordinate>"
                 "<Coordinate name=\"rotation\"><range>-0.7 0.7</range></Coordinate></coordinates>"
                 "<SpatialTransform>{}{}{}</SpatialTransform></CustomJoint></objects></JointSet><ForceSet>"
                 "<objects>{}</objects></ForceSet></Model></OpenSimDocument>",
                 pelvis, thigh, made_axis(1, "flexion", "0 0 1"), made_axis(2, "adduction", "1 0 0"),
                 made_axis(3, "rotation", "0 1 0"), muscles),
             "hip.osim")
      .model();
}

void expect_arms(const test::ArmCounts& counts, int most_sticking_out, int most_without_slope, double largest) {
  testing::Test::RecordProperty(
      "arms", fmt::format("{}: {} stick out, {} are no slopes, {} of them unnamed, largest {:.1f} mm", counts.arms,
                          counts.stick_out, counts.no_slope, counts.unnamed, 1e3 * counts.largest));
  EXPECT_EQ(counts.arms, 60000);
  EXPECT_LE(counts.stick_out, most_sticking_out) << counts.where;
  EXPECT_LE(counts.no_slope, most_without_slope) << counts.where;
  EXPECT_EQ(counts.unnamed, 0) << counts.where;
  EXPECT_LE(counts.largest, largest);
}

// The levers of the points are up to 140 mm; the larger arms are of points deep inside a cylinder.
TEST(MadeHip, ArmsOverCylindersWithEndsAreSlopesThatDoNotStickOut) {
  expect_arms(test::count_arms(made_hip(false), 500), 0, 2, 0.21);
}

TEST(MadeHip, ArmsOverCylindersThatCrossAreSlopesButBesideJumps) {
  expect_arms(test::count_arms(made_hip(true), 500), 0, 5, 0.7);
}

}  // namespace
}  // namespace veridyn::muscle
