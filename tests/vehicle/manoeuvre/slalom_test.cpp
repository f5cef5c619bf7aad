#include "veridyn/vehicle/manoeuvre/slalom.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/refusal.hpp"
#include "tests/vehicle/manoeuvre/tangent_drive.hpp"

namespace veridyn::vehicle {
namespace {

VehicleTrajectory tangent_drive(const Path& path, double side = 1.0) {
  return testing::tangent_drive(path, 10.0, side);
}

TEST(Slalom, ThePathPassesEveryConeAtItsClearanceInTurn) {
  const Slalom course = slalom_course(5, 20.0, 0.6, 1.8);
  double s = 0.0;
  for (int i = 0; i < course.cones; ++i) {
    EXPECT_NEAR(course.cone(i), 40.0 + 20.0 * i, 1e-12);
    s = course.path.nearest(course.cone(i), 0.0, s + 20.0, 15.0);
    const PathPoint at = course.path.at(s);
    EXPECT_NEAR(at.x, course.cone(i), 1e-6) << i;
    EXPECT_NEAR(at.y, Slalom::side(i) * (0.9 + 0.6), 1e-9) << i;
    EXPECT_NEAR(at.heading, 0.0, 1e-6) << i;
  }
  const PathPoint end = course.path.at(course.path.length());
  EXPECT_NEAR(end.y, 0.0, 1e-9);
  EXPECT_NEAR(end.x, course.cone(4) + 10.0 + 40.0, 1e-9);
  // Two neighbouring turns are mirror images.
  const auto curvature = [&](double x) { return course.path.at(course.path.nearest(x, 0.0)).curvature; };
  EXPECT_NEAR(curvature(course.cone(1) + 5.0), -curvature(course.cone(2) + 5.0), 1e-6);
}

TEST(Slalom, SeesWhoHitsAConeAndWhoPassesOnTheWrongSide) {
  const Slalom course = slalom_course(4, 25.0, 0.5, 1.8);
  const ConeCheck well = check_cones(tangent_drive(course.path), course, {1.2, 1.4, 1.8});
  EXPECT_EQ(well.hit, 0);
  EXPECT_EQ(well.passed, 4);
  EXPECT_NEAR(well.margin, 0.5, 1e-6);  // at the cones the body is parallel to their line
  const ConeCheck wide = check_cones(tangent_drive(course.path), course, {1.2, 1.4, 2.9});
  EXPECT_EQ(wide.hit, 4);
  EXPECT_NEAR(wide.margin, well.margin - 0.55, 1e-9);
  const ConeCheck mirrored = check_cones(tangent_drive(course.path, -1.0), course, {1.2, 1.4, 1.8});
  EXPECT_EQ(mirrored.hit, 4);
  EXPECT_LT(mirrored.margin, -2.0);
  VehicleTrajectory straight;
  for (double x = 0.0; x < 70.0; x += 0.1) {
    straight.time.push_back(x);
    straight.x.push_back(x);
    straight.y.push_back(2.0);
    straight.yaw.push_back(0.0);
  }
  const ConeCheck short_drive = check_cones(straight, course, {1.2, 1.4, 1.8});
  EXPECT_EQ(short_drive.passed, 2);
  EXPECT_EQ(short_drive.hit, 1);
  EXPECT_NEAR(short_drive.margin, -2.9, 1e-12);
  EXPECT_EQ(short_drive.nearest, 2);
}

TEST(Slalom, RefusesACourseThatNobodyCanSetUp) {
  EXPECT_EQ(why([] { (void)slalom_course(0, 18.0, 0.5, 1.8); }), "slalom: cones is 0; must be 1 to 1000");
  EXPECT_EQ(why([] { (void)slalom_course(8, std::nan(""), 0.5, 1.8); }), "slalom: spacing is nan; must be > 0 m");
  EXPECT_EQ(why([] { (void)slalom_course(8, 18.0, -0.1, 1.8); }), "slalom: clearance is -0.1; must be >= 0 m");
  EXPECT_EQ(why([] { (void)slalom_course(8, 90.0, 0.5, 1.8); }), "slalom: spacing is 90; must be less than 80 m");
}

}  // namespace
}  // namespace veridyn::vehicle
