#include "veridyn/vehicle/manoeuvre/path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::vehicle {
namespace {

TEST(Path, ACircleHasItsRadiusAndGrowsWithTheLaps) {
  const Path path = Path::circle(33.0, -1);
  EXPECT_NEAR(path.length(), 66.0 * kPi, 1e-10);
  for (const double s : {0.0, 10.0, 100.0, 500.0}) {
    const PathPoint p = path.at(s);
    EXPECT_NEAR(std::hypot(p.x, p.y + 33.0), 33.0, 1e-10);
    EXPECT_NEAR(p.curvature, -1.0 / 33.0, 1e-15);
    EXPECT_NEAR(p.heading, -s / 33.0, 1e-11);
    EXPECT_NEAR(path.nearest(p.x * 1.01, (p.y + 33.0) * 1.01 - 33.0, s + 2.0), s, 1e-8);
  }
}

TEST(Path, PiecesJoinWithPositionAndHeading) {
  Path path(1.0, 2.0, 0.5);
  path.append_line(10.0).append_arc(5.0, 0.1).append_lane_change(30.0, 3.5).append_line(4.0);
  for (const double joint : {10.0, 15.0, path.length() - 4.0}) {
    const PathPoint before = path.at(joint - 1e-9), after = path.at(joint + 1e-9);
    EXPECT_NEAR(before.x, after.x, 1e-8);
    EXPECT_NEAR(before.y, after.y, 1e-8);
    EXPECT_NEAR(before.heading, after.heading, 1e-8);
  }
  // The lane change shifts by 3.5 m to the left of its beginning and ends in its direction.
  const PathPoint begin = path.at(15.0), end = path.at(path.length() - 4.0);
  EXPECT_NEAR(-std::sin(begin.heading) * (end.x - begin.x) + std::cos(begin.heading) * (end.y - begin.y), 3.5, 1e-9);
  EXPECT_NEAR(end.heading, begin.heading, 1e-9);
  // Beyond the ends the tangents go on.
  EXPECT_NEAR(path.at(-2.0).x, 1.0 - 2.0 * std::cos(0.5), 1e-12);
}

// Arc length, heading and curvature are derivatives of one another, everywhere on a polynomial piece.
TEST(Path, ArcLengthHeadingAndCurvatureBelongTogether) {
  Path path;
  path.append({{0.0, 20.0, 5.0, -3.0, 2.0, 1.0}, {0.0, 2.0, 10.0, -4.0, 3.0, -1.0}});
  const double h = 1e-4;
  for (double s = 0.01; s < path.length() - 0.01; s += 0.37) {
    const PathPoint before = path.at(s - h), at = path.at(s), after = path.at(s + h);
    EXPECT_NEAR(std::hypot(after.x - before.x, after.y - before.y), 2.0 * h, 1e-10);
    EXPECT_NEAR((after.heading - before.heading) / (2.0 * h), at.curvature, 1e-6);
    EXPECT_NEAR(std::atan2(after.y - before.y, after.x - before.x), at.heading, 1e-7);
  }
}

TEST(Path, ASplineThroughACircleHasItsCurvature) {
  std::vector<double> x, y;
  for (int i = 0; i <= 60; ++i) {
    x.push_back(50.0 * std::sin(0.05 * i));
    y.push_back(50.0 - 50.0 * std::cos(0.05 * i));
  }
  const Path path = Path::through(x, y);
  EXPECT_NEAR(path.length(), 150.0, 1e-6);
  for (const double s : {20.0, 75.3, 130.0}) EXPECT_NEAR(path.at(s).curvature, 0.02, 1e-7);
  EXPECT_EQ(why([] {
              (void)Path::through(std::vector{0.0, 1.0, 1.0, 2.0}, std::vector{0.0, 0.0, 0.0, 0.0});
            }),
            "path: points 2 and 3 coincide or are not finite");
  EXPECT_EQ(why([] {
              (void)Path::through(std::vector{0.0, 1.0}, std::vector{0.0, 0.0});
            }),
            "path: has 2 points; must have at least 4");
}

TEST(Path, MovedToTheOriginItIsTheSameCurve) {
  Path path(-7.0, 3.0, 2.0);
  path.append_arc(10.0, -0.05).append_lane_change(20.0, 2.0);
  const Path moved = path.from_origin();
  EXPECT_EQ(moved.at(0.0).x, 0.0);
  EXPECT_EQ(moved.at(0.0).heading, 0.0);
  for (const double s : {3.0, 14.0, 25.0}) {
    EXPECT_NEAR(moved.at(s).curvature, path.at(s).curvature, 1e-12);
    EXPECT_NEAR(moved.at(s).heading, path.at(s).heading - 2.0, 1e-12);
    EXPECT_NEAR(std::hypot(moved.at(s).x, moved.at(s).y), std::hypot(path.at(s).x + 7.0, path.at(s).y - 3.0), 1e-11);
  }
}

TEST(Path, TheNearestPointIsSquareToThePath) {
  Path path;
  path.append_line(20.0).append_lane_change(40.0, 6.0).append_line(20.0);
  for (const double s : {5.0, 27.0, 41.0, 70.0}) {
    const PathPoint p = path.at(s);
    const double left = 1.3;
    const double x = p.x - left * std::sin(p.heading), y = p.y + left * std::cos(p.heading);
    EXPECT_NEAR(path.nearest(x, y), s, 1e-7);
    EXPECT_NEAR(path.nearest(x, y, s - 3.0), s, 1e-7);
  }
}

}  // namespace
}  // namespace veridyn::vehicle
