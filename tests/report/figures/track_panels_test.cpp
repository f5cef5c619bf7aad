#include "veridyn/report/figures/track_panels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/report/shown.hpp"

namespace veridyn::report {
namespace {

TEST(SingularValuePanel, ShowsDecadesAndLeavesAGapWhereThereIsNoLogarithm) {
  aircraft::TrackHistory history;
  history.time = {0.0, 1.0};
  history.singular_value = {{1000.0, 100.0}, {0.0, 0.01}};
  history.threshold = {10.0, 10.0};
  const Panel panel = singular_value_panel(history);
  ASSERT_THAT(test::lines_of(panel), testing::ElementsAre("s1", "s2", "threshold"));
  EXPECT_NEAR(panel.lines[0].y[0], 3.0, 1e-12);
  EXPECT_NEAR(panel.lines[0].y[1], 2.0, 1e-12);
  EXPECT_TRUE(std::isnan(panel.lines[1].y[0]));
  EXPECT_NEAR(panel.lines[1].y[1], -2.0, 1e-12);
  EXPECT_NEAR(panel.lines[2].y[0], 1.0, 1e-12);
  EXPECT_EQ(panel.lines[2].role, Role::kReference);
}

}  // namespace
}  // namespace veridyn::report
