#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/live/time/fixed_rate.hpp"
#include "veridyn/live/time/latency_histogram.hpp"

namespace veridyn::live {
namespace {

TEST(FixedRate, DeadlinesStayOnTheGridWhateverStepsTake) {
  FixedRate rate(1000, 100);
  EXPECT_EQ(rate.next(), 1000);
  EXPECT_EQ(rate.advance(1001), 0U);
  EXPECT_EQ(rate.next(), 1100);
  EXPECT_EQ(rate.advance(1299), 0U);  // late, but the next deadline has only just passed
  EXPECT_EQ(rate.next(), 1200);
  EXPECT_EQ(rate.advance(1555), 2U);
  EXPECT_EQ(rate.next(), 1500);
  EXPECT_EQ(rate.left_out(), 2U);
}

TEST(RealClock, SleepsUntilATimeAndNotLonger) {
  RealClock clock;
  const Nanoseconds begin = clock.now();
  clock.sleep_until(begin + 5 * kMillisecond);
  EXPECT_GE(clock.now(), begin + 5 * kMillisecond);
  clock.sleep_until(begin);  // has passed
  EXPECT_LT(clock.now() - begin, 5 * kSecond);
}

TEST(SetClock, StandsUntilItIsToldAndNeverGoesBack) {
  SetClock clock(7);
  EXPECT_EQ(clock.now(), 7);
  clock.sleep_until(9);
  EXPECT_EQ(clock.now(), 9);
  clock.set(8);
  EXPECT_EQ(clock.now(), 9);
}

TEST(LatencyHistogram, QuantilesAreThoseOfWhatWentInToABin) {
  LatencyHistogram h;
  EXPECT_TRUE(std::isnan(h.quantile(0.5)));
  for (int k = 1; k <= 10000; ++k) h.add(k * 1000);  // 1 us to 10 ms, evenly
  EXPECT_EQ(h.count(), 10000U);
  EXPECT_NEAR(h.mean(), 5.0005e-3, 1e-12);
  const double bin = std::pow(10.0, 1.0 / LatencyHistogram::kPerDecade);
  for (const double share : {0.01, 0.5, 0.99, 0.9999}) {
    EXPECT_GE(h.quantile(share), share * 1e-2 * 0.9999) << share;
    EXPECT_LE(h.quantile(share), share * 1e-2 * bin * 1.0001) << share;
  }
  EXPECT_EQ(h.quantile(1.0), 1e-2);
}

TEST(LatencyHistogram, TakesWhatIsShorterAndLongerThanItsBins) {
  LatencyHistogram h;
  h.add(-5);
  h.add(0);
  h.add(1000 * kSecond);
  EXPECT_EQ(h.bins().front(), 2U);
  EXPECT_EQ(h.bins().back(), 1U);
  EXPECT_EQ(h.largest(), 1000 * kSecond);
}

}  // namespace
}  // namespace veridyn::live
