#include "veridyn/vehicle/manoeuvre/path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/folders.hpp"
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

const char* const kBezier = R"(3 9
 0 0 0.1   0 0 0.1   10 0 0.1
 30 4 0.1  20 4 0.1  40 4 0.1
 60 4 0.1  70 4 0.1  60 4 0.1
)";

// Bezier's construction at the middle: (P0 + 3 P1 + 3 P2 + P3)/8.
TEST(Path, ReadsBezierKnots) {
  const Path path = parse_bezier_path(kBezier, "path.txt");
  const double s = path.nearest((0.0 + 30.0 + 60.0 + 30.0) / 8.0, (0.0 + 0.0 + 12.0 + 4.0) / 8.0);
  EXPECT_NEAR(path.at(s).x, 15.0, 1e-8);
  EXPECT_NEAR(path.at(s).y, 2.0, 1e-8);
  // Control points along the line that overshoot do not turn the path back.
  EXPECT_NEAR(path.at(path.length()).x, 60.0, 1e-12);
  EXPECT_NEAR(path.length(), path.nearest(30.0, 4.0) + 30.0, 1e-8);
}

TEST(Path, RefusesBrokenFilesWithTheLine) {
  const auto of = [](const std::string& text) { return why([&] { (void)parse_bezier_path(text, "path.txt"); }); };
  EXPECT_EQ(of(""), "path.txt: is empty; expected the number of knots and of columns");
  EXPECT_EQ(of("2 4\n"), "path.txt:1: knots have 4 columns; must be 3 or 9");
  EXPECT_EQ(of("3 3\n0 0 0\n1 0 0\n"), "path.txt:1: promises 3 knots, but there are 2");
  EXPECT_EQ(of("2 9\n0 0 0\n1 0 0\n"), "path.txt:2: has 3 numbers, expected 9");
  EXPECT_EQ(of("2 3\n0 0 x\n1 0 0\n"), "path.txt:2: 'x' is not a finite number");
  EXPECT_EQ(of("2 9\n0 0 0 0 0 0 0 0 0\n0 0 0 0 0 0 0 0 0\n"), "path.txt:3: the knot coincides with the one before");
}

TEST(Path, ReadsTablesOfPoints) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "veridyn_path_test.csv";
  std::ofstream(file) << "x[m],y[cm]\n0,0\n10,0\n20,0\n30,0\n";
  EXPECT_NEAR(read_path(file).length(), 30.0, 1e-9);
  std::ofstream(file) << "x[m],y[deg]\n0,0\n10,0\n20,0\n30,0\n";
  EXPECT_NE(why([&] { (void)read_path(file); }).find("column y is in rad, expected a length [m]"), std::string::npos);
  std::filesystem::remove(file);
}

TEST(Path, ReadsTheLaneChangesOfProjectChrono) {
  const std::filesystem::path folder = test::shared_folder() / "data/vehicle/chrono";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no recorded data next to the sources: " << folder;
  for (const char* name :
       {"ISO_double_lane_change.txt", "ISO_double_lane_change2.txt", "NATO_double_lane_change.txt"}) {
    const Path path = read_path(folder / name);
    const PathPoint begin = path.at(0.0), end = path.at(path.length());
    EXPECT_GT(path.length(), end.x - begin.x) << name;
    EXPECT_LT(path.length(), 1.02 * (end.x - begin.x)) << name;
    double widest = 0.0;
    for (double s = 0.0; s < path.length(); s += 0.1) widest = std::max(widest, path.at(s).y - begin.y);
    EXPECT_NEAR(widest,
                std::string(name) == "ISO_double_lane_change2.txt" ? 3.586
                : name[0] == 'I'                                   ? 4.0
                                                                   : 3.6105,
                0.01)
        << name;
  }
}

}  // namespace
}  // namespace veridyn::vehicle
