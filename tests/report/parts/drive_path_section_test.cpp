#include "veridyn/report/parts/drive_path_section.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/shown.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::report {
namespace {

using testing::ElementsAre;

TEST(DrivePathSection, ShowsWhatWasRecordedAndNothingWhereNothingWas) {
  EXPECT_TRUE(drive_path_section({}).blocks.empty());
  vehicle::DrivePath path;
  path.heading = {.rmse = 0.5 * kDegree, .at_end = 1.25 * kDegree, .samples = 2};
  path.distance_m = 312.4;
  path.time = {0.0, 0.1, 0.1};
  path.yaw = {0.0, 0.1, kNaN};
  path.yaw_model = {0.0, 0.2, kNaN};
  path.x = path.y = path.x_model = path.y_model = {kNaN, kNaN, kNaN};
  const Section heading = drive_path_section(path);
  check({.sections = {heading}});
  const Table errors = test::table_of(heading.blocks, "Heading and path");
  ASSERT_EQ(errors.rows.size(), 1U);
  EXPECT_THAT(test::shown_row(errors, 0), ElementsAre("heading", "0.500", "1.25", "deg", "312"));
  EXPECT_TRUE(test::blocks_of<XYPlot>(heading.blocks).empty());
  path.position = {.rmse = 2.0, .at_end = 3.5, .samples = 2};
  path.across_rmse = 0.75;
  path.x = path.y = path.x_model = path.y_model = {0.0, 1.0, kNaN};
  const Section both = drive_path_section(path);
  check({.sections = {both}});
  EXPECT_THAT(test::shown_row(test::table_of(both.blocks, "Heading and path"), 1),
              ElementsAre("position", "2.00", "3.50", "m", "312"));
  const auto plots = test::blocks_of<XYPlot>(both.blocks);
  ASSERT_EQ(plots.size(), 1U);
  EXPECT_TRUE(plots[0].equal_scale);
  EXPECT_EQ(plots[0].series.size(), 2U);
}

}  // namespace
}  // namespace veridyn::report
