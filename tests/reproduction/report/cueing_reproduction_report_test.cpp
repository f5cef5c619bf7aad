#include "bench/reproduction/report/cueing_reproduction_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/shown.hpp"

namespace veridyn::report {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

cueing::CueingReproduction two_figures() {
  cueing::CueingReproduction r;
  r.title = "pitch of a ramp";
  r.finding = "18.5 deg are reached";
  r.how = "simulated";
  r.figures = {
      {.quantity = "pitch", .origin = "printed", .published = 18.5, .ours = 18.3, .within = 0.5, .unit = "deg"},
      {.quantity = "lag", .origin = "derived", .published = 0.25, .ours = 0.31, .within = 0.05, .unit = "s"}};
  return r;
}

TEST(CueingReproductionReport, ShowsEachFigureNextToTheOneThatWasPublished) {
  const ReproducedRow row = reproduced_row(two_figures());
  EXPECT_EQ(row.title, "pitch of a ramp");
  EXPECT_EQ(row.finding, "18.5 deg are reached");
  EXPECT_EQ(row.ours, "simulated");
  const Table table = test::table_of(row.blocks, "Figures");
  check({.sections = {{.blocks = row.blocks}}});
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_THAT(test::shown_row(table, 0), ElementsAre("pitch", "printed", "18.500", "18.300", "0.500", "deg", "good"));
  EXPECT_EQ(table.rows[1].cells.back().status, Status::kBad);
}

TEST(CueingReproductionReport, PassesOnlyWhenEveryFigureIsMet) {
  cueing::CueingReproduction r = two_figures();
  const ReproducedRow missed = reproduced_row(r);
  ASSERT_EQ(missed.checks.size(), 2U);
  EXPECT_TRUE(missed.checks[0].passed);
  EXPECT_EQ(missed.checks[1].text, "lag: derived 0.25 s, ours 0.31, within 0.05");
  EXPECT_FALSE(missed.passed());
  r.figures[1].ours = 0.26;
  EXPECT_TRUE(reproduced_row(r).passed());
}

TEST(CueingReproductionReport, DrawsEachCurveInAPanelOfItsOwn) {
  cueing::CueingReproduction r = two_figures();
  EXPECT_THAT(test::blocks_of<TimeSeries>(reproduced_row(r).blocks), IsEmpty());
  r.time = {0.0, 1.0};
  r.curves = {{.name = "with camera", .unit = "mm", .values = {0.0, 0.1}},
              {.name = "without", .unit = "m", .values = {0.0, 5.0}}};
  const std::vector<TimeSeries> figures = test::blocks_of<TimeSeries>(reproduced_row(r).blocks);
  ASSERT_EQ(figures.size(), 1U);
  check({.sections = {{.blocks = {figures[0]}}}});
  EXPECT_THAT(test::labels_of(figures[0]), ElementsAre("with camera", "without"));
  EXPECT_EQ(figures[0].panels[1].unit, "m");
  EXPECT_EQ(figures[0].axis, "pitch of a ramp") << "rows zoom independently";
}

}  // namespace
}  // namespace veridyn::report
