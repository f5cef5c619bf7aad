#include "bench/reproduction/report/reproduction_report.hpp"

#include <gtest/gtest.h>

namespace veridyn::report {
namespace {

TEST(ReproductionReport, FoldsWhatWasReproducedAndShowsWhatWasNot) {
  const std::vector<ReproducedRow> rows{{.title = "seen", .ours = "so", .checks = {{.passed = true, .text = "a"}}},
                                        {.title = "missed", .ours = "so", .checks = {{.passed = false, .text = "b"}}}};
  const Document document = reproduction_report("vehicle", rows, "veridyn test");
  check(document);
  EXPECT_EQ(document.verdict.level, Level::kBad);
  EXPECT_EQ(document.verdict.headline, "1 of 2 published results show what they must.");
  ASSERT_EQ(document.sections.size(), 3U);
  EXPECT_FALSE(document.sections[0].folded) << "the summary";
  EXPECT_TRUE(document.sections[1].folded);
  EXPECT_FALSE(document.sections[2].folded);
}

}  // namespace
}  // namespace veridyn::report
