#include "veridyn/recording/time_order.hpp"

#include <gmock/gmock.h>

namespace veridyn::recording {
namespace {

using ::testing::HasSubstr;

DelayReport report(double delay_s, double sigma_s, double correlation = 0.9) {
  return {.group = "attitude",
          .reference = "gyro",
          .delay_s = delay_s,
          .sigma_s = sigma_s,
          .correlation = correlation,
          .finding = correlation < 0.0 ? DelayFinding::kOppositeSign : DelayFinding::kApplied};
}

TEST(TimeOrder, IsEarlyBeyondLimitAndChance) {
  EXPECT_TRUE(is_early(report(-0.05, 0.01), {}));
  EXPECT_FALSE(is_early(report(-0.05, 0.02), {})) << "within three standard errors";
  EXPECT_FALSE(is_early(report(-0.02, 0.001), {})) << "within the limit";
  EXPECT_FALSE(is_early(report(0.2, 0.001), {})) << "late, as sensors are";
  EXPECT_FALSE(is_early(report(-0.05, 0.0), {.early_s = 0.08}));
  EXPECT_FALSE(is_early(report(-0.05, 0.01, -0.9), {}));
}

TEST(TimeOrder, NamesWhatIsEarlyOrOpposite) {
  const estimation::Evidence early = early_row(report(-0.05, 0.01), {});
  EXPECT_EQ(early.about, "attitude");
  EXPECT_EQ(early.outcome, estimation::Outcome::kCare);
  EXPECT_THAT(early.text, HasSubstr("attitude shows the motion 0.05 s before gyro"));
  EXPECT_THAT(early.advice, HasSubstr("delays.attitude = \"-50 ms\""));
  EXPECT_THAT(early_row(report(-0.05, 0.0), {.is_control = true}).text, HasSubstr("0.05 s after its effect"));
  EXPECT_TRUE(is_opposite(report(0.0, 0.0, -0.9)));
  EXPECT_FALSE(is_opposite(report(0.0, 0.0)));
  EXPECT_THAT(opposite_row(report(0.0, 0.0, -0.9)).text, HasSubstr("moves against what gyro implies"));
  EXPECT_EQ(late_row("gyro", "attitude", 0.1, 0.03).about, "gyro");
}

TEST(TimeOrder, TellsHowToTakeOffADelayInDoubt) {
  DelayReport servo = report(0.07, 0.01, 0.7);
  EXPECT_FALSE(is_doubtful(servo, {})) << "it was taken off";
  servo.finding = DelayFinding::kInDoubt;
  EXPECT_TRUE(is_doubtful(servo, {}));
  EXPECT_FALSE(is_doubtful(servo, {.early_s = 0.08}));
  const estimation::Evidence row = doubtful_row(servo, {});
  EXPECT_EQ(row.outcome, estimation::Outcome::kCare);
  EXPECT_THAT(row.text, HasSubstr("0.070 +- 0.010 s early"));
  EXPECT_THAT(row.advice, HasSubstr("delays.attitude = \"-70 ms\""));
  servo.sigma_s = 0.03;
  EXPECT_FALSE(is_doubtful(servo, {})) << "within three standard errors";
}

}  // namespace
}  // namespace veridyn::recording
