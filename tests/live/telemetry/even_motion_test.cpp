#include "veridyn/live/telemetry/even_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/live/weaving_drive.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::live {
namespace {

Telemetry telemetry(const recording::MotionSample& sample, Nanoseconds arrival, bool restarted = false) {
  return {.sample = sample, .arrival = arrival, .restarted = restarted};
}

TEST(EvenMotion, IsOnLinesBetweenPacketsAndLaterByTheDelay) {
  const auto drive = test::weaving_drive(10.0);
  EvenMotion even({.delay = 0.05, .extrapolate = 0.03});
  SenderClock clock;
  numerics::RandomStream random(2, "stamps");
  // Stamps 7 to 31 ms apart, as recorded of a game; they arrive 2 ms after.
  double t = 0.0, worst = 0.0;
  Nanoseconds next = 3 * kSecond;
  while (t < 9.0) {
    t += random.uniform(0.007, 0.031);
    recording::MotionSample s = drive[static_cast<std::size_t>(std::lround(t / 0.01))];
    t = s.time;
    const Nanoseconds arrival = nanoseconds(t + 2.002);
    for (; next < arrival; next += 10 * kMillisecond) {
      const auto e = even.at(next, clock);
      if (!e) continue;
      EXPECT_EQ(e->extrapolated, 0.0);
      if (t < 1.0) continue;
      const double then = seconds(next) - 2.002 - 0.05;
      EXPECT_NEAR(e->sample.time, then, 1e-6);
      const auto k = static_cast<std::size_t>(then / 0.01);
      const double part = then / 0.01 - static_cast<double>(k);
      const Eigen::Vector3d truth = drive[k].force + part * (drive[k + 1].force - drive[k].force);
      worst = std::max(worst, (e->sample.force - truth).norm());
    }
    clock.add(t, arrival);
    even.add(telemetry(s, arrival));
  }
  EXPECT_GT(worst, 0.0);
  // A line over 40 ms of a sine of 0.8 rad/s and 5 m/s^2: h^2/8 max|f''|.
  EXPECT_LT(worst, 0.04 * 0.04 / 8.0 * 8.0);
}

TEST(EvenMotion, GoesOnStraightForAsLongAsAllowedAndThenStays) {
  EvenMotion even({.delay = 0.0, .extrapolate = 0.03});
  SenderClock clock;
  recording::MotionSample s;
  for (int k = 0; k < 10; ++k) {
    s.time = 0.01 * k;
    s.force = {10.0 * s.time, 0.0, kGravity};
    s.attitude = Eigen::AngleAxisd(s.time, Eigen::Vector3d::UnitZ());
    clock.add(s.time, nanoseconds(s.time));
    even.add(telemetry(s, nanoseconds(s.time)));
  }
  const auto at = [&](double t) { return *even.at(nanoseconds(t), clock); };
  EXPECT_NEAR(at(0.1).sample.force.x(), 1.0, 1e-9);
  EXPECT_NEAR(at(0.1).extrapolated, 0.01, 1e-9);
  EXPECT_NEAR(at(0.12).sample.force.x(), 1.2, 1e-9);
  EXPECT_NEAR(at(0.12).sample.attitude.angularDistance(Eigen::Quaterniond::Identity()), 0.12, 1e-9);
  EXPECT_NEAR(at(5.0).sample.force.x(), 1.2, 1e-9);
  EXPECT_NEAR(at(5.0).extrapolated, 0.03, 1e-9);
  EXPECT_NEAR(at(5.0).age, 4.91, 1e-9);
}

TEST(EvenMotion, ForgetsWhatWasBeforeADriveThatBeganAgain) {
  EvenMotion even;
  SenderClock clock;
  EXPECT_FALSE(even.at(0, clock));
  recording::MotionSample s;
  s.time = 100.0;
  s.speed = 30.0;
  clock.add(s.time, 0);
  even.add(telemetry(s, 0));
  s.time = 1.0;
  s.speed = 0.0;
  clock.reset();
  clock.add(s.time, kSecond);
  even.add(telemetry(s, kSecond, true));
  EXPECT_EQ(even.at(kSecond, clock)->sample.speed, 0.0);
}

}  // namespace
}  // namespace veridyn::live
