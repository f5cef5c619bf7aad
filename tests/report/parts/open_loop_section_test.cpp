#include "veridyn/report/parts/open_loop_section.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/shown.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::report {
namespace {

using testing::ElementsAre;

/// Two samples of alpha in each of two windows, the first of each where the initial state is estimated.
estimation::OpenLoop by_hand() {
  estimation::OpenLoop flown;
  flown.text = "2 windows";
  flown.times.duration_s = 10.0;
  flown.inputs = "deflections and thrust";
  flown.offsets = {"Cm"};
  flown.windows = {{.group = "longitudinal",
                    .span = {20.0, 30.0},
                    .forecast_from = 22.0,
                    .start = {{0, "alpha at 20.0 s", "rad", 0.1}, {0, "Cm added from 20.0 s on", "1", 0.0123}},
                    .first_left_s = 1.5},
                   {.group = "longitudinal",
                    .span = {90.0, 95.0},
                    .forecast_from = 92.0,
                    .diverged = true,
                    .start = {{1, "alpha at 90.0 s", "rad", 0.1}, {1, "Cm added from 90.0 s on", "1", -0.02}},
                    .first_left_s = 0.0}};
  estimation::OpenLoopState alpha{.name = "alpha", .unit = "deg", .group = "longitudinal"};
  alpha.fit = {.mae = 0.2, .rmse = 0.314, .bias = 0.0, .r2 = 0.91, .theil = 0.0456, .count = 2};
  alpha.normalised_rmse = 0.3;
  alpha.shares = {0.25, 0.05, 0.70};
  alpha.inside = 0.94;
  alpha.horizon_s = 1.5;
  alpha.windows = 2;
  alpha.held = 1;
  alpha.time = {20.0, 20.1, 20.2, 20.2, 90.0, 90.1, 90.2, 90.2};
  alpha.measured = {0.1, 0.1, 0.1, kNaN, 0.1, 0.1, 0.1, kNaN};
  alpha.predicted = {0.1, 0.2, 0.2, kNaN, 0.1, 0.2, 0.2, kNaN};
  alpha.sigma = {kNaN, 0.01, 0.01, kNaN, kNaN, 0.02, 0.02, kNaN};
  flown.states = {alpha};
  return flown;
}

TEST(OpenLoopSection, ShowsScoresBandsAndWhereEachWindowStarted) {
  const Section section = open_loop_section(by_hand());
  check({.sections = {section}});
  const Table scores = test::table_of(section.blocks, "Open loop");
  ASSERT_EQ(scores.rows.size(), 1U);
  EXPECT_THAT(test::shown_row(scores, 0),
              ElementsAre("alpha", "0.314", "deg", "0.300", "0.0456", "25", "5", "70", "94", "1.5", "1 of 2"));
  const auto figures = test::blocks_of<TimeSeries>(section.blocks);
  ASSERT_EQ(figures.size(), 1U) << "nothing was flown laterally";
  EXPECT_EQ(figures[0].windows.size(), 2U);
  const Line& model = figures[0].panels[0].lines[1];
  EXPECT_NEAR(model.band->high[1] - model.y[1], 1.959963984540054 * 0.01 / kDegree, 1e-9);
  const Table windows = test::table_of(section.blocks, "Windows");
  EXPECT_EQ(test::shown_in(windows, windows.rows[0], "added Cm"), "0.0123");
  EXPECT_EQ(test::shown_in(windows, windows.rows[1], ""), "diverged");
}

// A car has one group of states, whose offsets are angles.
TEST(OpenLoopSection, ShowsAnglesInDegreesAndNoAxisWhereThereIsOneGroup) {
  estimation::OpenLoop driven = by_hand();
  driven.inputs = "steering and speed";
  driven.offsets = {"steer_bias"};
  for (estimation::OpenLoopState& state : driven.states) state.group.clear();
  for (estimation::OpenLoopWindow& window : driven.windows) {
    window.group.clear();
    window.start.back() = {0, "steer_bias", "rad", kDegree};
  }
  const Section section = open_loop_section(driven);
  check({.sections = {section}});
  EXPECT_EQ(section.title, "Open loop, from steering and speed");
  ASSERT_EQ(test::blocks_of<TimeSeries>(section.blocks).size(), 1U);
  const Table windows = test::table_of(section.blocks, "Windows");
  EXPECT_EQ(windows.columns.front().name, "from");
  EXPECT_EQ(test::shown_in(windows, windows.rows[0], "added steer_bias"), "1.00");
}

TEST(OpenLoopSection, HasNothingToSayWhereNothingWasAskedForAndSaysWhyNothingCouldBeFlown) {
  estimation::OpenLoop nothing;
  EXPECT_TRUE(open_loop_section(nothing).blocks.empty());
  nothing.text = "nothing was flown open loop: no unseen stretch lasts 4 s with all signals";
  EXPECT_EQ(open_loop_section(nothing).blocks.size(), 1U);
}

}  // namespace
}  // namespace veridyn::report
