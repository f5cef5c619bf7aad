#include "veridyn/vehicle/manoeuvre/lane_change.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/vehicle/manoeuvre/tangent_drive.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {
namespace {

VehicleTrajectory along(const Path& path, double shift = 0.0) { return testing::tangent_drive(path, 20.0, 1.0, shift); }

// The middles of the lanes for a width of 1.72 m are those of the path that Project Chrono ships: 3.586 and 0.172 m.
TEST(LaneChange, LanesFollowTheStandardAndTheWidth) {
  const DoubleLaneChange course = iso_double_lane_change(1.72);
  const auto middle = [&](std::size_t i) { return 0.5 * (course.lanes[i].left + course.lanes[i].right); };
  EXPECT_NEAR(middle(0), 0.0, 1e-12);
  EXPECT_NEAR(middle(1), 3.586, 1e-12);
  EXPECT_NEAR(middle(2), 0.172, 1e-12);
  EXPECT_NEAR(course.lanes[1].left - course.lanes[1].right, 1.2 * 1.72 + 0.25, 1e-12);
  EXPECT_NEAR(course.lanes[2].end - course.lanes[0].begin, 125.0, 1e-12);
}

TEST(LaneChange, ItsPathStaysWithinTheLanes) {
  const DoubleLaneChange course = iso_double_lane_change(1.75);
  const LaneCheck check = check_lanes(along(course.path), course, {1.25, 1.0, 1.75});
  EXPECT_TRUE(check.within) << check.margin << " in lane " << check.lane;
  EXPECT_TRUE(check.finished);
}

// Lengths as in the standard, 61 m together; the vehicle's width decides the lanes' and where the second lies.
TEST(LaneChange, ObstacleAvoidanceHasTheLengthsAndWidthsOfTheStandard) {
  const double w = 1.8;
  const DoubleLaneChange course = iso_obstacle_avoidance(w);
  const auto& [first, second, third] = course.lanes;
  EXPECT_EQ(course.standard, "ISO 3888-2");
  EXPECT_NEAR(first.end - first.begin, 12.0, 1e-12);
  EXPECT_NEAR(second.begin - first.end, 13.5, 1e-12);
  EXPECT_NEAR(second.end - second.begin, 11.0, 1e-12);
  EXPECT_NEAR(third.begin - second.end, 12.5, 1e-12);
  EXPECT_NEAR(third.end - third.begin, 12.0, 1e-12);
  EXPECT_NEAR(third.end - first.begin, 61.0, 1e-12);
  EXPECT_NEAR(first.left - first.right, 1.1 * w + 0.25, 1e-12);
  EXPECT_NEAR(second.left - second.right, w + 1.0, 1e-12);
  EXPECT_NEAR(third.left - third.right, 1.3 * w + 0.25, 1e-12);
  EXPECT_NEAR(second.right - first.left, 1.0, 1e-12);
  EXPECT_NEAR(third.right, first.right, 1e-12);
  const Lane wide = iso_obstacle_avoidance(2.3).lanes[2];
  EXPECT_NEAR(wide.left - wide.right, 3.0, 1e-12);
}

TEST(LaneChange, ThePathOfTheObstacleAvoidanceStaysWithinTheLanesAndScales) {
  for (const double width : {1.6, 1.8, 2.1}) {
    const DoubleLaneChange course = iso_obstacle_avoidance(width);
    const LaneCheck check = check_lanes(along(course.path), course, {1.15, 1.55, width});
    EXPECT_TRUE(check.within) << width << ": " << check.margin << " in lane " << check.lane;
    EXPECT_TRUE(check.finished);
    EXPECT_GT(check.margin, 0.05) << width;
  }
  const DoubleLaneChange full = iso_obstacle_avoidance(1.75), small = iso_obstacle_avoidance(0.35, 0.2);
  EXPECT_NEAR(small.path.length(), 0.2 * full.path.length(), 1e-9);
  EXPECT_NEAR(small.lanes[1].left, 0.2 * full.lanes[1].left, 1e-12);
}

TEST(LaneChange, SeesABodyThatTouchesACone) {
  const DoubleLaneChange course = iso_double_lane_change(1.75);
  const BodyOutline body{1.25, 1.0, 1.75};
  // In the first lane there are (0.1 w + 0.25)/2 on either side of a vehicle in its middle.
  const double clearance = 0.5 * (0.1 * 1.75 + 0.25);
  Path straight;
  straight.append_line(60.0);
  const LaneCheck touching = check_lanes(along(straight, -clearance - 0.01), course, body);
  EXPECT_FALSE(touching.within);
  EXPECT_NEAR(touching.margin, -0.01, 1e-9);
  EXPECT_EQ(touching.lane, 1);
  // A body that swings around a cone between its corners: straight, at an angle, only its flank over the lane's end.
  VehicleTrajectory slanted;
  slanted.time = {0.0};
  slanted.x = {course.lanes[0].end};
  slanted.y = {0.0};
  slanted.yaw = {0.3};
  const BodyOutline thin{2.0, 0.5, 0.02};
  // The flank crosses the end of the lane at its middle; the corner inside it lies 0.5 m back and 0.15 m to the right.
  const LaneCheck check = check_lanes(slanted, course, thin);
  EXPECT_NEAR(check.margin, 0.5 * (1.1 * 1.75 + 0.25) - (0.5 * std::sin(0.3) + 0.01 * std::cos(0.3)), 1e-9);
  EXPECT_FALSE(check.finished);
  // Moved to the left all corners pass, and the flank hits the last cone of the lane.
  slanted.y = {course.lanes[0].left + 0.05};
  EXPECT_NEAR(check_lanes(slanted, course, thin).margin, -(0.05 + 0.01 / std::cos(0.3)), 1e-9);
}

TEST(LaneChange, ScalesWithTheCourse) {
  const DoubleLaneChange full = iso_double_lane_change(1.75), small = iso_double_lane_change(0.35, 0.2);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(small.lanes[i].left, 0.2 * full.lanes[i].left, 1e-12);
    EXPECT_NEAR(small.lanes[i].end, 0.2 * full.lanes[i].end, 1e-12);
  }
  EXPECT_NEAR(small.path.length(), 0.2 * full.path.length(), 1e-9);
  EXPECT_THROW((void)iso_double_lane_change(0.0), InputError);
  EXPECT_THROW((void)iso_double_lane_change(1.75, -1.0), InputError);
}

}  // namespace
}  // namespace veridyn::vehicle
