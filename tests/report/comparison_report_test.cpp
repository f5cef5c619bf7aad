#include "veridyn/report/comparison_report.hpp"

#include <gtest/gtest.h>

namespace veridyn::report {
namespace {

TEST(ComparisonReport, ShowsPairsAndParameters) {
  std::vector<estimation::NamedEstimate> estimates(2);
  for (std::size_t i = 0; i < 2; ++i) {
    estimation::Parameter p{.name = "CL_alpha", .value = 4.0 + static_cast<double>(i), .sigma = 0.1};
    p.status = estimation::ParameterStatus::kIdentified;
    estimates[i].name = i == 0 ? "first" : "second";
    estimates[i].estimate.parameters = {p};
  }
  const Document document = comparison_report(estimation::compare_estimates(estimates), estimates, "veridyn");
  EXPECT_EQ(document.verdict.level, Level::kBad);
  ASSERT_FALSE(document.sections.empty());
  EXPECT_EQ(document.sections.front().blocks.size(), 3U);
  EXPECT_EQ(document.facts.size(), 2U);
}

}  // namespace
}  // namespace veridyn::report
