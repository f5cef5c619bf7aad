#include "veridyn/live/telemetry/sender_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/numerics/random.hpp"

namespace veridyn::live {
namespace {

/// Packets at 100 Hz whose way takes 1 ms and sometimes much longer.
SenderClock clock_after(double duration, double drift, double offset, double& last_stamp) {
  numerics::RandomStream random(3, "ways");
  SenderClock clock;
  double arrival = 0.0;
  for (int k = 0; k * 0.01 <= duration; ++k) {
    const double t = k * 0.01, stamp = t * (1.0 - drift);
    const double way = 1e-3 + (random.uniform() < 0.7 ? 0.2e-3 : 20e-3) * random.uniform();
    arrival = std::max(arrival, t + offset + way);
    clock.add(stamp, nanoseconds(arrival));
    last_stamp = stamp;
  }
  return clock;
}

TEST(SenderClock, FindsTheOffsetOfTheQuickestPackets) {
  double stamp = 0.0;
  const SenderClock clock = clock_after(20.0, 0.0, 123.4, stamp);
  EXPECT_NEAR(clock.ours(stamp) - stamp, 123.4 + 1e-3, 0.1e-3);
  EXPECT_NEAR(clock.theirs(clock.ours(5.0)), 5.0, 1e-9);
  EXPECT_NEAR(clock.lateness(stamp, nanoseconds(stamp + 123.4 + 21e-3)), 20e-3, 0.2e-3);
}

TEST(SenderClock, TellsHowFastTheSendersClockDrifts) {
  for (const double drift : {-500e-6, -50e-6, 0.0, 50e-6, 500e-6}) {
    double stamp = 0.0;
    const SenderClock clock = clock_after(60.0, drift, 5.0, stamp);
    EXPECT_NEAR(clock.drift(), drift, 10e-6);
    // And the offset follows it: 60 s of 500 ppm are 30 ms.
    EXPECT_NEAR(clock.ours(stamp), stamp / (1.0 - drift) + 5.0 + 1e-3, 3e-3) << drift;
  }
}

TEST(SenderClock, DoesNotJudgeADriftTooEarly) {
  double stamp = 0.0;
  EXPECT_TRUE(std::isnan(clock_after(8.0, 0.0, 0.0, stamp).drift()));
}

TEST(SenderClock, SaysWhichClockIsPoorAboveAHundredPartsInAMillion) {
  EXPECT_EQ(drift_warning(99e-6), "");
  EXPECT_EQ(drift_warning(std::nan("")), "");
  EXPECT_EQ(drift_warning(-250e-6).substr(0, 49), "the sender's clock runs 250 ppm fast against ours");
  EXPECT_EQ(drift_warning(101e-6).substr(0, 49), "the sender's clock runs 101 ppm slow against ours");
}

}  // namespace
}  // namespace veridyn::live
