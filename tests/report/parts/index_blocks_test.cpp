#include "veridyn/report/parts/index_blocks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/shown.hpp"

namespace veridyn::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<std::string> kTwoInputs{"mass", "grip"};

TEST(IndexPlot, HasFirstAndTotalOrderOfEachInputWithTheirIntervals) {
  estimation::ResultIndices indices{.result = "task 8"};
  indices.variance.inputs = {
      {.first = 0.7, .total = 0.8, .first_low = 0.6, .first_high = 0.75, .total_low = 0.7, .total_high = 0.9},
      {.first = 0.1, .total = 0.2, .first_low = 0.0, .first_high = 0.15, .total_low = 0.1, .total_high = 0.3}};
  indices.variance.evaluations = 256;
  indices.variance.dropped = 3;
  const IntervalPlot plot = index_plot({.indices = indices, .inputs = kTwoInputs, .quantity = "the NRMSE"}, 0.95);
  check({.sections = {{.blocks = {plot}}}});
  EXPECT_EQ(plot.title, "task 8");
  // 256 runs are 64 samples of N (inputs + 2) points.
  EXPECT_THAT(plot.caption, HasSubstr("variance of the NRMSE; 95 % bootstrap intervals. 3 of 64 samples"));
  EXPECT_THAT(plot.methods, ElementsAre("first order", "total order"));
  ASSERT_EQ(plot.rows.size(), 2U);
  EXPECT_EQ(plot.rows[1].name, "grip");
  EXPECT_EQ(plot.rows[1].estimates[0].value, 0.1);
  EXPECT_EQ(plot.rows[1].estimates[1].value, 0.2);
  EXPECT_EQ(plot.rows[0].estimates[0].high, 0.75);
  EXPECT_EQ(plot.rows[0].estimates[1].low, 0.7);
  EXPECT_TRUE(plot.shared_scale) << "shares compare with each other";
}

TEST(MorrisTable, ShowsEffectsInTheUnitOfTheReader) {
  estimation::ResultIndices indices{.result = "yaw gain"};
  indices.morris = {{.mean = -0.02, .absolute = 0.03, .sd = 0.004}, {.mean = 0.0, .absolute = 0.0, .sd = 0.0}};
  const Table table =
      morris_table({.indices = indices, .inputs = kTwoInputs, .quantity = "the gain", .unit = "%", .factor = 100.0});
  check({.sections = {{.blocks = {table}}}});
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_THAT(test::shown_row(table, 0), ElementsAre("mass", "3.00", "−2.00", "0.400"));
  EXPECT_EQ(table.columns[1].unit, "%");
  EXPECT_THAT(table.caption, HasSubstr("change of the gain over an input's whole range"));
}

TEST(IndexExplanation, IsOfTheIndicesThatAreShown) {
  EXPECT_THAT(index_explanation(true).text, HasSubstr("Total order"));
  EXPECT_THAT(index_explanation(false).text, HasSubstr("Morris"));
  EXPECT_EQ(index_explanation(true).tone, Tone::kNote);
}

}  // namespace
}  // namespace veridyn::report
