#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/folders.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/vehicle/manoeuvre/path.hpp"

namespace veridyn::vehicle {
namespace {

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
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "path.csv";
  std::ofstream(file) << "x[m],y[cm]\n0,0\n10,0\n20,0\n30,0\n";
  EXPECT_NEAR(read_path(file).length(), 30.0, 1e-9);
  std::ofstream(file) << "x[m],y[deg]\n0,0\n10,0\n20,0\n30,0\n";
  EXPECT_NE(why([&] { (void)read_path(file); }).find("column y is in rad, expected a length [m]"), std::string::npos);
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
