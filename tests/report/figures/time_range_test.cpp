#include "veridyn/report/figures/time_range.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace veridyn::report {
namespace {

using testing::ElementsAre;

/// A line over the figure's samples 0, 1, ... 9 with a band, and one over its own.
TimeSeries ten_seconds() {
  TimeSeries figure{.panels = {{.lines = {{.name = "shared", .band = Band{}},
                                          {.name = "own", .y = {0.0, 5.0, 10.0}, .x = {0.0, 5.0, 10.0}}}}},
                    .spans = {{.from = 0.0, .to = 1.0}, {.from = 2.0, .to = 6.0}}};
  Line& shared = figure.panels[0].lines[0];
  for (int k = 0; k < 10; ++k) {
    for (std::vector<double>* values : {&figure.samples, &shared.y, &shared.band->low, &shared.band->high})
      values->push_back(k);
  }
  return figure;
}

TEST(KeepWithin, LeavesLinesBandsAndSpansOfTheRange) {
  TimeSeries figure = ten_seconds();
  const Window range{3.0, 5.5};
  keep_within(figure, std::span(&range, 1));
  EXPECT_THAT(figure.samples, ElementsAre(3.0, 4.0, 5.0));
  EXPECT_THAT(figure.panels[0].lines[0].y, ElementsAre(3.0, 4.0, 5.0));
  EXPECT_THAT(figure.panels[0].lines[0].band->high, ElementsAre(3.0, 4.0, 5.0));
  EXPECT_THAT(figure.panels[0].lines[1].y, ElementsAre(5.0));
  ASSERT_EQ(figure.spans.size(), 1U);
  EXPECT_EQ(figure.spans[0].from, 3.0);
  EXPECT_EQ(figure.spans[0].to, 5.5);
}

TEST(InLongestWindows, LeavesTheLongestInTheOrderOfTime) {
  TimeSeries figure = ten_seconds();
  figure.windows = {{0.0, 2.0}, {3.0, 4.0}, {6.0, 9.0}};
  const TimeSeries both = in_longest_windows(figure, 2);
  ASSERT_EQ(both.windows.size(), 2U);
  EXPECT_EQ(both.windows[0].from, 0.0);
  EXPECT_EQ(both.windows[1].from, 6.0);
  EXPECT_THAT(both.samples, ElementsAre(0.0, 1.0, 2.0, 6.0, 7.0, 8.0, 9.0));
  EXPECT_THAT(both.caption, testing::HasSubstr("The 2 longest of 3 stretches"));
  EXPECT_EQ(in_longest_windows(figure, 3).caption, "");
  const TimeSeries begun = in_longest_windows(figure, 3, 2.5);
  EXPECT_EQ(begun.windows[2].to, 8.5);
  EXPECT_EQ(begun.caption, "The first 2.5 s of each at most; all are further down.");
  EXPECT_EQ(in_longest_windows(figure, 2, 2.5).caption,
            "The 2 longest of 3 stretches, the first 2.5 s of each at most; all are further down.");
}

TEST(ShowRange, IsOfFiguresWithoutWindows) {
  TimeSeries with_windows = ten_seconds();
  with_windows.windows = {{0.0, 2.0}};
  Section section{.blocks = {ten_seconds(), with_windows, Paragraph{"text"}}};
  show_range(section, {4.0, 6.0}, "time_2");
  EXPECT_EQ(std::get<TimeSeries>(section.blocks[0]).samples.size(), 3U);
  EXPECT_EQ(std::get<TimeSeries>(section.blocks[0]).axis, "time_2");
  EXPECT_EQ(std::get<TimeSeries>(section.blocks[1]).samples.size(), 10U);
}

}  // namespace
}  // namespace veridyn::report
