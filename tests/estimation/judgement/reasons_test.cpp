#include "veridyn/estimation/judgement/reasons.hpp"

#include <gtest/gtest.h>

#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::estimation {
namespace {

Evidence held(const char* about, double samples) {
  return row_of(Check::kHeldSamples, about, samples).with("channel", std::string(about)).with("rate_Hz", 5.0);
}

TEST(Reasons, AreTheWorstFirstWithWhatToDoAndNothingTwice) {
  const std::vector<Evidence> rows{
      held("gyro", 4.0), held("vane", 9.0), held("airspeed", 1.0),
      row_of(Check::kClippedSamples, "accel_z", 0.2).with("channel", std::string("accel_z")).with("end_of_range", 9.0)};
  const Reasons reasons = reasons_of(rows);
  ASSERT_EQ(reasons.lines.size(), 4U);
  EXPECT_EQ(reasons.lines[0].outcome, Outcome::kFailed);
  EXPECT_TRUE(reasons.lines[1].is_advice);
  EXPECT_NE(reasons.lines[2].text.find("gyro"), std::string::npos);
  EXPECT_TRUE(reasons.lines[2].text.ends_with(" (likewise vane)")) << reasons.lines[2].text;
  EXPECT_TRUE(reasons.lines[3].is_advice);
  EXPECT_EQ(reasons.left_out, 0U);
  EXPECT_TRUE(reasons.quotes(0) && reasons.quotes(3));
  EXPECT_FALSE(reasons.quotes(1)) << "it is only named";
  const Reasons few = reasons_of(rows, 2);
  EXPECT_EQ(few.lines.size(), 2U);
  EXPECT_EQ(few.left_out, 2U);
}

TEST(Reasons, AreNoneWhereAllPassed) { EXPECT_TRUE(reasons_of(std::vector{held("gyro", 1.0)}).lines.empty()); }

TEST(Mentions, AreWholeWords) {
  EXPECT_TRUE(mentions("accel_y is reversed", "accel_y"));
  EXPECT_TRUE(mentions("the scale of a", "a"));
  EXPECT_FALSE(mentions("a clear case", "e"));
  EXPECT_FALSE(mentions("accel_y_bias is large", "accel_y"));
  EXPECT_FALSE(mentions("the gyro", ""));
}

}  // namespace
}  // namespace veridyn::estimation
