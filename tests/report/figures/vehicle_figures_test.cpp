#include "veridyn/report/figures/vehicle_figures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/report/shown.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::report {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using vehicle::VehicleTrajectory;

/// Three samples of a bicycle: both wheels of an axle are alike, there are no longitudinal forces and no ride.
VehicleTrajectory bicycle_motion() {
  VehicleTrajectory t;
  t.time = {0.0, 1.0, 2.0};
  t.x = {0.0, 20.0, 40.0};
  t.y = {0.0, 1.0, 4.0};
  t.u = {20.0, 20.0, 20.0};
  t.v = {0.0, 0.1, 0.1};
  t.r = t.yaw = t.yaw_acceleration = t.steer = {0.0, 0.1, 0.2};
  t.lateral_acceleration = {0.0, 4.903325, 9.80665};
  t.longitudinal_acceleration = {0.0, 0.0, -9.80665};
  for (std::size_t w = 0; w < vehicle::kWheels; ++w) {
    t.slip_angle[w] = t.Fy[w] = {0.0, w < 2 ? 0.1 : 0.2, 0.0};
    t.slip_ratio[w] = t.Fx[w] = {0.0, 0.0, 0.0};
  }
  return t;
}

const Panel& panel_of(const TimeSeries& figure, const std::string& label) {
  for (const Panel& panel : figure.panels) {
    if (panel.label == label) return panel;
  }
  throw std::runtime_error("no panel " + label);
}

TEST(PathFigure, IsToScaleAndHasALineForEachDrive) {
  const VehicleTrajectory a = bicycle_motion(), b = bicycle_motion();
  const std::vector<ShownDrive> drives{{.name = "a", .trajectory = &a},
                                       {.name = "b", .trajectory = &b, .role = Role::kReference}};
  const XYPlot plot = path_figure(drives);
  EXPECT_TRUE(plot.equal_scale);
  ASSERT_EQ(plot.series.size(), 2U);
  EXPECT_EQ(plot.series[0].x, a.x);
  EXPECT_EQ(plot.series[0].y, a.y);
  EXPECT_EQ(plot.series[1].role, Role::kReference);
}

TEST(CourseSeries, AreTheEdgesOfLanesAndTheConesOfASlalom) {
  vehicle::Manoeuvre manoeuvre;
  EXPECT_THAT(course_series(manoeuvre), IsEmpty());
  manoeuvre.slalom = vehicle::slalom_course(3, 18.0, 0.5, 1.75);
  const std::vector<XYSeries> cones = course_series(manoeuvre);
  ASSERT_EQ(cones.size(), 1U);
  EXPECT_THAT(cones[0].x, ElementsAre(40.0, 58.0, 76.0));
  EXPECT_THAT(cones[0].y, ElementsAre(0.0, 0.0, 0.0));
  EXPECT_EQ(cones[0].style, Style::kMarkers);
  manoeuvre.slalom.reset();
  manoeuvre.course = vehicle::iso_obstacle_avoidance(1.8);
  const std::vector<XYSeries> edges = course_series(manoeuvre);
  ASSERT_EQ(edges.size(), 6U) << "left and right of three lanes";
  const vehicle::Lane& second = manoeuvre.course->lanes[1];
  EXPECT_THAT(edges[2].x, ElementsAre(second.begin, second.end));
  EXPECT_THAT(edges[2].y, ElementsAre(second.left, second.left));
  EXPECT_THAT(edges[3].y, ElementsAre(second.right, second.right));
  for (const XYSeries& edge : edges) EXPECT_EQ(edge.style, Style::kLine);
}

TEST(GGFigure, CountsInTheGravityOfTheDriveAndLeavesOutModelsWithoutAccelerations) {
  const VehicleTrajectory drive = bicycle_motion();
  VehicleTrajectory without = bicycle_motion();
  without.longitudinal_acceleration.clear();
  const std::vector<ShownDrive> drives{{.name = "a", .trajectory = &drive}, {.name = "b", .trajectory = &without}};
  const XYPlot plot = g_g_figure(drives, kGravity);
  ASSERT_EQ(plot.series.size(), 1U);
  EXPECT_NEAR(plot.series[0].x[1], 0.5, 1e-12) << "lateral";
  EXPECT_NEAR(plot.series[0].y[2], -1.0, 1e-12) << "longitudinal";
  EXPECT_NEAR(g_g_figure(drives, kGravity / 6.0).series[0].x[1], 3.0, 1e-12) << "on the moon";
}

TEST(MotionFigure, ShowsTheSpeedOnlyWhereItChanges) {
  VehicleTrajectory t = bicycle_motion();
  const std::vector<ShownDrive> drives{{.name = "drive", .trajectory = &t}};
  const TimeSeries steady = motion_figure(drives);
  check({.sections = {{.blocks = {steady}}}});
  EXPECT_THAT(test::labels_of(steady), ElementsAre("steer angle", "yaw", "yaw rate", "yaw acceleration",
                                                   "lateral acceleration", "lateral velocity"));
  EXPECT_NEAR(panel_of(steady, "yaw rate").lines[0].y[1], 0.1 / kDegree, 1e-12);
  t.u.back() = 15.0;
  EXPECT_EQ(panel_of(motion_figure(drives), "speed").lines[0].y.back(), 15.0);
}

TEST(MotionFigure, KeepsTheTimeOfADriveThatIsSampledOtherwise) {
  const VehicleTrajectory first = bicycle_motion(), same = bicycle_motion();
  VehicleTrajectory cut = bicycle_motion();
  for (auto* values :
       {&cut.time, &cut.steer, &cut.yaw, &cut.r, &cut.yaw_acceleration, &cut.lateral_acceleration, &cut.v})
    values->pop_back();
  const TimeSeries figure = motion_figure(std::vector<ShownDrive>{
      {.name = "a", .trajectory = &first}, {.name = "b", .trajectory = &same}, {.name = "c", .trajectory = &cut}});
  check({.sections = {{.blocks = {figure}}}});
  EXPECT_EQ(figure.samples, first.time);
  const Panel& steer = panel_of(figure, "steer angle");
  EXPECT_THAT(steer.lines[0].x, IsEmpty());
  EXPECT_THAT(steer.lines[1].x, IsEmpty());
  EXPECT_EQ(steer.lines[2].x, cut.time);
}

TEST(TyreFigure, HasALineForEachAxleWhereLeftAndRightAreAlike) {
  VehicleTrajectory t = bicycle_motion();
  const std::vector<ShownDrive> drives{{.name = "drive", .trajectory = &t}};
  const TimeSeries alike = tyre_figure(drives);
  EXPECT_THAT(test::labels_of(alike), ElementsAre("slip angle", "lateral force")) << "no longitudinal forces";
  EXPECT_THAT(test::lines_of(alike.panels[0]), ElementsAre("front", "rear"));
  EXPECT_NEAR(alike.panels[0].lines[1].y[1], 0.2 / kDegree, 1e-12);
  t.slip_angle[0][1] = 0.15;
  t.slip_ratio[3] = {0.0, 0.02, 0.0};
  const TimeSeries four = tyre_figure(drives);
  EXPECT_THAT(test::lines_of(four.panels[0]), ElementsAre("fl", "fr", "rl", "rr"));
  EXPECT_THAT(test::lines_of(panel_of(four, "slip ratio")), ElementsAre("rr")) << "three wheels roll freely";
  EXPECT_NEAR(panel_of(four, "slip ratio").lines[0].y[1], 2.0, 1e-12) << "per cent";
}

TEST(TyreFigure, NamesTheDriveWhereThereAreSeveral) {
  const VehicleTrajectory t = bicycle_motion();
  const TimeSeries figure =
      tyre_figure(std::vector<ShownDrive>{{.name = "twin", .trajectory = &t}, {.name = "car", .trajectory = &t}});
  EXPECT_THAT(test::lines_of(figure.panels[0]), ElementsAre("twin front", "twin rear", "car front", "car rear"));
}

TEST(RideFigure, IsEmptyOfABicycleAndTakesStaticLoadsOff) {
  VehicleTrajectory t = bicycle_motion();
  const std::vector<ShownDrive> drives{{.name = "drive", .trajectory = &t}};
  for (std::vector<double>& Fz : t.Fz) Fz = {4000.0, 4000.0, 4000.0};
  EXPECT_THAT(ride_figure(drives).panels, IsEmpty()) << "it has loads, and they rest";
  t.roll = {0.0, 0.02, 0.0};
  t.heave = {0.0, 0.01, 0.0};
  for (std::size_t w = 0; w < vehicle::kWheels; ++w)
    t.Fz[w] = {4000.0 + 100.0 * static_cast<double>(w), 4500.0, 4000.0};
  const TimeSeries absolute = ride_figure(drives);
  EXPECT_THAT(test::labels_of(absolute), ElementsAre("roll", "heave", "normal force"));
  EXPECT_NEAR(panel_of(absolute, "heave").lines[0].y[1], 10.0, 1e-12) << "mm";
  EXPECT_EQ(panel_of(absolute, "normal force").lines[2].y[0], 4200.0);
  const std::vector<vehicle::PerWheel<double>> loads{{{4000.0, 4100.0, 4200.0, 4300.0}}};
  const TimeSeries relative = ride_figure(drives, loads);
  const Panel& force = panel_of(relative, "normal force less static load");
  for (const Line& line : force.lines) EXPECT_EQ(line.y[0], 0.0) << line.name;
  EXPECT_EQ(force.lines[3].y[1], 200.0);
}

}  // namespace
}  // namespace veridyn::report
