#include "veridyn/report/parts/aircraft_open_loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/shown.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::report {
namespace {

using aircraft::Axis;
using testing::ElementsAre;

/// Two samples of alpha in each of two windows, the first of each where the initial state is estimated.
aircraft::FlightAnalysis flown_by_hand() {
  aircraft::FlightAnalysis analysis;
  aircraft::OpenLoop& flown = analysis.open_loop;
  flown.text = "2 windows";
  flown.options.duration_s = 10.0;
  flown.offsets = {aircraft::Coefficient::kCm};
  flown.windows = {{.axis = Axis::kLongitudinal,
                    .span = {20.0, 30.0},
                    .forecast_from = 22.0,
                    .start = {{0, "alpha at 20.0 s", "rad", 0.1}, {0, "Cm added from 20.0 s on", "1", 0.0123}},
                    .first_left_s = 1.5},
                   {.axis = Axis::kLongitudinal,
                    .span = {90.0, 95.0},
                    .forecast_from = 92.0,
                    .diverged = true,
                    .start = {{1, "alpha at 90.0 s", "rad", 0.1}, {1, "Cm added from 90.0 s on", "1", -0.02}},
                    .first_left_s = 0.0}};
  aircraft::OpenLoopState alpha{.name = "alpha", .unit = "deg", .axis = Axis::kLongitudinal};
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
  return analysis;
}

TEST(OpenLoopSection, ShowsScoresBandsAndWhereEachWindowStarted) {
  const Section section = open_loop_section(flown_by_hand());
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

TEST(OpenLoopSection, HasNothingToSayWhereNothingWasAskedForAndSaysWhyNothingCouldBeFlown) {
  aircraft::FlightAnalysis analysis;
  EXPECT_TRUE(open_loop_section(analysis).blocks.empty());
  analysis.open_loop.text = "nothing was flown open loop: no unseen stretch lasts 4 s with all signals";
  EXPECT_EQ(open_loop_section(analysis).blocks.size(), 1U);
}

}  // namespace
}  // namespace veridyn::report
