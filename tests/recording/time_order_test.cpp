#include "veridyn/recording/time_order.hpp"

#include <gmock/gmock.h>

#include "veridyn/estimation/judgement/check.hpp"

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
  DelayReport open = report(-0.05, 0.01);
  open.finding = DelayFinding::kNoPeak;
  EXPECT_FALSE(is_early(open, {})) << "not determined";
}

TEST(TimeOrder, NamesWhatIsEarlyOrOpposite) {
  const estimation::Evidence early = early_row(report(-0.05, 0.01), {});
  EXPECT_EQ(early.about, "attitude");
  EXPECT_EQ(early.outcome, estimation::Outcome::kCare);
  EXPECT_THAT(says(early), HasSubstr("attitude shows the motion 0.05 s before gyro"));
  EXPECT_THAT(advice_of(early), HasSubstr("delays.attitude = \"-50 ms\""));
  EXPECT_THAT(says(early_row(report(-0.05, 0.0), {.is_control = true})), HasSubstr("0.05 s after its effect"));
  EXPECT_TRUE(is_opposite(report(0.0, 0.0, -0.9)));
  EXPECT_FALSE(is_opposite(report(0.0, 0.0)));
  EXPECT_EQ(opposite_row(report(0.0, 0.0, -0.9)).check, estimation::Check::kSignAgainstOthers);
  EXPECT_EQ(opposite_row(report(0.0, 0.0, -0.9)).outcome, estimation::Outcome::kCare);
}

// What turns the sign of a derivative is no matter of care.
TEST(TimeOrder, OfAControlFailsBeyondItsLimitAndChance) {
  const TimeOrder order{.failed_s = 0.1, .is_control = true};
  EXPECT_EQ(early_row(report(-0.22, 0.01), order).outcome, estimation::Outcome::kFailed);
  EXPECT_EQ(early_row(report(-0.22, 0.05), order).outcome, estimation::Outcome::kCare) << "within three errors of it";
  EXPECT_EQ(early_row(report(-0.08, 0.01), order).outcome, estimation::Outcome::kCare);
  EXPECT_EQ(early_row(report(-0.22, 0.01), {.is_control = true}).outcome, estimation::Outcome::kCare);
  EXPECT_NEAR(early_row(report(-0.22, 0.01), order).limit, -0.1, 1e-12);
}

TEST(TimeOrder, TellsHowToTakeOffADelayInDoubt) {
  DelayReport servo = report(0.07, 0.01, 0.7);
  EXPECT_FALSE(is_doubtful(servo, {})) << "it was taken off";
  servo.finding = DelayFinding::kInDoubt;
  EXPECT_TRUE(is_doubtful(servo, {}));
  EXPECT_FALSE(is_doubtful(servo, {.early_s = 0.08}));
  const estimation::Evidence row = doubtful_row(servo, {});
  EXPECT_EQ(row.outcome, estimation::Outcome::kCare);
  EXPECT_THAT(says(row), HasSubstr("0.070 +- 0.010 s early"));
  EXPECT_THAT(advice_of(row), HasSubstr("delays.attitude = \"-70 ms\""));
  servo.sigma_s = 0.03;
  EXPECT_FALSE(is_doubtful(servo, {})) << "within three standard errors";
}

}  // namespace
}  // namespace veridyn::recording
