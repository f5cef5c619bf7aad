#include "veridyn/camera/calibration/calibration_points.hpp"

#include <gtest/gtest.h>

#include "tests/camera/synthetic_camera.hpp"
#include "tests/support/refusal.hpp"

namespace veridyn::camera {
namespace {

constexpr const char* kHeader = "world_x[m],world_y[m],image_x,image_y\n";

std::string refusal(const std::string& rows) {
  return why([&] { (void)parse_calibration_points(kHeader + rows, "points.csv"); });
}

TEST(CalibrationPoints, ReadBackToTheSameNumbers) {
  const CalibrationPoints points = testing::grid_points(testing::wide_camera(), 0.5, 0.1, 7);
  const CalibrationPoints again = parse_calibration_points(to_csv(points), "again");
  ASSERT_EQ(again.points.size(), points.points.size());
  for (std::size_t i = 0; i < points.points.size(); ++i) {
    EXPECT_EQ(again.points[i].track, points.points[i].track);
    EXPECT_EQ(again.points[i].image, points.points[i].image);
    EXPECT_EQ(again.points[i].line, i + 2);
  }
}

TEST(CalibrationPoints, AreReadWithSemicolonsAtTheEndAndInOtherUnits) {
  const CalibrationPoints points = parse_calibration_points(
      "world_x[mm]; world_y[cm]; image_x; image_y;\n0; 0; 1; 2;\n1000; 0; 401; 2;\n0; 100; 1; "
      "402;\n1000;100;401;402;\n",
      "p");
  EXPECT_EQ(points.points[3].track, Eigen::Vector2d(1.0, 1.0));
  EXPECT_EQ(points.points[3].image, Eigen::Vector2d(401.0, 402.0));
}

TEST(CalibrationPoints, AreRefusedWhereNoMapCanBeFitted) {
  EXPECT_EQ(refusal("0,0,1,1\n1,0,2,1\n1,1,2,2\n"), "points.csv: holds 3 points; a map of the track needs at least 4");
  EXPECT_EQ(
      refusal("0,0,1,1\n1,1,2,2\n2,2,3,1\n3,3,4,7\n4,4,5,9\n"),
      "points.csv:6: all 5 points up to here are on a line on the track: four are needed of which no three are on "
      "a line");
  EXPECT_EQ(refusal("0,0,1,1\n1,1,2,2\n2,2,3,1\n1,3,4,7\n4,4,5,9\n"),
            "points.csv:5: all 5 points but this one are on a line on the track: four are needed of which no three are "
            "on a line");
  EXPECT_EQ(refusal("5,0,1,1\n1,1,2,2\n2,2,3,1\n3,3,4,7\n4,4,5,9\n").substr(0, 61),
            "points.csv:2: all 5 points but this one are on a line on the ");
  EXPECT_EQ(
      refusal("0,0,1,1\n1,0,2,2\n1,1,3,3\n0,1,4,4\n"),
      "points.csv:5: all 4 points up to here are on a line in the image: four are needed of which no three are on "
      "a line");
  EXPECT_EQ(refusal("0,0,7,7\n1,0,7,7\n1,1,7,7\n0,1,7,7\n"),
            "points.csv:5: all 4 points up to here have the same place in the image: nothing can be fitted");
  EXPECT_EQ(refusal("0,0,7,7\n1,0,,7\n1,1,7,7\n0,1,7,7\n"),
            "points.csv:3: a coordinate is missing or not a finite number");
  EXPECT_EQ(refusal("0,0,7,7\n1,0,nan,7\n1,1,7,7\n0,1,7,7\n"),
            "points.csv:3: a coordinate is missing or not a finite number");
  EXPECT_EQ(refusal("0,0,7,7\n1,0,x,7\n"), "points.csv:3: column 'image_x': 'x' is not a number");
  EXPECT_EQ(refusal("0,0,1,1\n1,0,100,1\n1,1,100,100\n0,1,1,100\n1,0,40,1\n"),
            "points.csv:6: the point (1, 0) m was elsewhere in the image at points.csv:3");
  EXPECT_NE(why([] {
              (void)parse_calibration_points("world_x[s],world_y,image_x,image_y\n1,2,3,4\n", "p");
            }).find("column 'world_x' is in s; must be a length"),
            std::string::npos);
  EXPECT_NE(why([] {
              (void)parse_calibration_points("world_x,y,image_x,image_y\n1,2,3,4\n", "p");
            }).find("has no column 'world_y'"),
            std::string::npos);
}

}  // namespace
}  // namespace veridyn::camera
