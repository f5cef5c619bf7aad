#include "veridyn/live/time/clock.hpp"

#include <gtest/gtest.h>

#include "tests/live/time/set_clock.hpp"

namespace veridyn::live {
namespace {

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

}  // namespace
}  // namespace veridyn::live
