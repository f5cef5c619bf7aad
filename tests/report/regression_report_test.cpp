#include "veridyn/report/regression_report.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace veridyn::report {
namespace {

TEST(RegressionReport, ShowsParametersFitAndEvidence) {
  estimation::RegressionData data;
  data.regressand_name = "z";
  data.parameter_names = {"constant", "x"};
  data.regressors = estimation::RowMatrix::Ones(100, 2);
  data.regressand.resize(100);
  for (Eigen::Index i = 0; i < 100; ++i) {
    data.regressors(i, 1) = static_cast<double>(i % 17);
    data.regressand(i) = 1.0 + 2.0 * data.regressors(i, 1) + 0.1 * static_cast<double>((i * 7) % 5);
  }
  Progress silent;
  const Document document =
      regression_report(estimation::judged_regression(std::move(data), {}, silent), "table.csv", "veridyn");
  const auto has = [&](const char* id) {
    return std::ranges::find(document.sections, id, &Section::id) != document.sections.end();
  };
  EXPECT_TRUE(has("fit"));
  EXPECT_FALSE(has("structure"));
  EXPECT_GE(document.sections.size(), 3U);
  EXPECT_EQ(document.facts.front().value, "table.csv");
}

}  // namespace
}  // namespace veridyn::report
