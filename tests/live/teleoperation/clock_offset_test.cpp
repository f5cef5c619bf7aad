#include "veridyn/live/teleoperation/clock_offset.hpp"

#include <gtest/gtest.h>

#include "veridyn/numerics/random.hpp"

namespace veridyn::live {
namespace {

TEST(ClockOffset, IsBoundedByOneExchange) {
  ClockOffset clock;
  EXPECT_FALSE(clock.offset(0));
  // The far clock is 1000 ms ahead; 7 ms out, 2 ms back.
  clock.outward(0, 1007 * kMillisecond, 10 * kMillisecond);
  EXPECT_FALSE(clock.offset(10 * kMillisecond));
  clock.backward(1008 * kMillisecond, 10 * kMillisecond, 10 * kMillisecond);
  const DelayBounds bounds = clock.offset(10 * kMillisecond).value();
  EXPECT_EQ(bounds.lowest, 998 * kMillisecond);
  EXPECT_EQ(bounds.highest, 1007 * kMillisecond);
}

TEST(ClockOffset, WidensByTheDriftAndNarrowsByFasterFrames) {
  ClockOffset clock;
  clock.outward(0, 5 * kMillisecond, 0);
  clock.backward(0, 5 * kMillisecond, 0);
  const DelayBounds later = clock.offset(100 * kSecond).value();  // 100 ppm of 100 s: 10 ms each way
  EXPECT_EQ(later.lowest, -15 * kMillisecond);
  EXPECT_EQ(later.highest, 15 * kMillisecond);
  // A slower one than what drift allows says nothing, a faster one does.
  clock.outward(100 * kSecond, 100 * kSecond + 16 * kMillisecond, 100 * kSecond);
  EXPECT_EQ(clock.offset(100 * kSecond)->highest, 15 * kMillisecond);
  clock.outward(100 * kSecond, 100 * kSecond + 3 * kMillisecond, 100 * kSecond);
  EXPECT_EQ(clock.offset(100 * kSecond)->highest, 3 * kMillisecond);
  EXPECT_EQ(clock.offset(100 * kSecond)->lowest, -15 * kMillisecond);
}

TEST(ClockOffset, HoldsTheTruthForClocksThatDriftByLess) {
  numerics::RandomStream random(1, "clocks");
  for (int round = 0; round < 50; ++round) {
    const double drift = random.uniform(-99e-6, 99e-6);
    const auto far = [&](Nanoseconds near) { return near + 77 * kSecond + nanoseconds(drift * seconds(near)); };
    ClockOffset clock;
    Nanoseconds now = 0;
    for (int k = 0; k < 200; ++k) {
      now += nanoseconds(random.uniform(0.0, 10.0));
      const Nanoseconds out = nanoseconds(random.uniform(0.0, 0.02)), back = nanoseconds(random.uniform(0.0, 0.02));
      if (random.index(2) == 0) clock.outward(now - back - out, far(now - back), now);
      if (random.index(2) == 0) clock.backward(far(now - back), now, now);
      if (const auto bounds = clock.offset(now)) {
        // What it drifts by while a frame is on its way is microseconds.
        ASSERT_LE(bounds->lowest, far(now) - now + 5'000);
        ASSERT_GE(bounds->highest, far(now) - now - 5'000);
      }
    }
    EXPECT_EQ(clock.contradictions(), 0U);
  }
}

TEST(ClockOffset, BeginsAgainWhereAClockWasSet) {
  ClockOffset clock;
  clock.outward(0, kMillisecond, 0);
  clock.backward(0, kMillisecond, 0);
  clock.outward(kSecond, kSecond - 500 * kMillisecond, kSecond);
  EXPECT_EQ(clock.contradictions(), 1U);
  EXPECT_FALSE(clock.offset(kSecond));
}

}  // namespace
}  // namespace veridyn::live
