#include "veridyn/report/response_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/report/document/html.hpp"

namespace veridyn::report {
namespace {

using ::testing::HasSubstr;

estimation::ResponseIndices two_inputs() {
  estimation::ResponseIndices r;
  r.inputs = {{.name = "C_f", .unit = "N/rad", .nominal = 6e4, .low = 5e4, .high = 7e4},
              {.name = "mass", .unit = "kg"}};
  r.responses = {{.name = "yaw_rate_gain", .unit = "1/s", .nominal = 7.0}};
  estimation::ResultIndices one{.result = "yaw_rate_gain"};
  one.variance.inputs = {
      {.first = 0.98, .total = 0.99, .first_low = 0.7, .first_high = 1.0, .total_low = 0.98, .total_high = 1.0},
      {.first = 0.01, .total = 0.02, .first_low = 0.0, .first_high = 0.02, .total_low = 0.0, .total_high = 0.03}};
  one.variance.evaluations = 40;
  r.results = {one};
  r.constant = {"roll_gain"};
  r.runs = 40;
  return r;
}

TEST(ResponseReport, ShowsWhatMovesWhat) {
  const Document d =
      response_report(two_inputs(), {}, {.program = "p", .title = "t", .subject = "s", .what = "a step"});
  EXPECT_EQ(d.verdict.level, Level::kGood);
  EXPECT_EQ(d.verdict.headline, "At least 5 % of the variance of some result is due to C_f.");
  ASSERT_FALSE(d.verdict.lines.empty());
  EXPECT_THAT(d.verdict.lines.front(), HasSubstr("Less of every result is due to mass"));
  const std::string html = to_html(d);
  EXPECT_THAT(html, HasSubstr("Which input moves which result"));
  EXPECT_THAT(html, HasSubstr("No input moves roll_gain."));
  EXPECT_THAT(html, HasSubstr("0.980 (0.700 to 1.000)"));
}

TEST(ResponseReport, SaysThatRunsFailedAndShowsMorris) {
  estimation::ResponseIndices r = two_inputs();
  r.failed = 3;
  r.results[0].variance = {};
  r.results[0].morris = {{.mean = 1.0, .absolute = 1.0}, {.mean = 0.01, .absolute = 0.01}};
  const Document d = response_report(r, {.method = estimation::IndexMethod::kMorris}, {});
  EXPECT_EQ(d.verdict.level, Level::kCaution);
  EXPECT_EQ(d.verdict.lines[1], "3 of 40 runs could not finish.");
  EXPECT_THAT(to_html(d), HasSubstr("Elementary effects"));
}

}  // namespace
}  // namespace veridyn::report
