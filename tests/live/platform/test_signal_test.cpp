#include "veridyn/live/platform/test_signal.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "veridyn/cueing/platform/platform_state.hpp"

namespace veridyn::live {
namespace {

using cueing::PlatformAxis;

TEST(TestSignal, StaysWithinTheLimitsAndBeginsAndEndsAtRest) {
  const cueing::AxisLimits limits = cueing::three_axis_limits()[PlatformAxis::kPitch];
  for (const TestSignal which : {TestSignal::kWave, TestSignal::kSweep}) {
    TestSignalOptions o{.signal = which, .size = 1.0, .frequency = 1.0, .duration = 20.0};
    constexpr double h = 1e-3;
    double rate = 0.0, acceleration = 0.0;
    EXPECT_EQ(wanted_position(o, limits, 0.0), 0.0);
    for (double t = 1.0 + 2.0 * h; t < 18.5; t += h) {
      const double a = wanted_position(o, limits, t - h), b = wanted_position(o, limits, t),
                   c = wanted_position(o, limits, t + h);
      EXPECT_LE(b, limits.highest);
      EXPECT_GE(b, limits.lowest);
      rate = std::max(rate, std::abs(c - a) / (2.0 * h));
      acceleration = std::max(acceleration, std::abs(a - 2.0 * b + c) / (h * h));
    }
    // The sweep's frequency and size change on the way; a few percent more come of that.
    EXPECT_LE(rate, 1.1 * limits.rate) << name_of(which);
    EXPECT_LE(acceleration, 1.1 * limits.acceleration) << name_of(which);
  }
  TestSignalOptions sweep{.duration = 20.0};
  EXPECT_NEAR(wanted_position(sweep, limits, 20.0), 0.0, 1e-12);
  EXPECT_EQ(sweep_frequency(sweep, 0.0), sweep.low);
  EXPECT_NEAR(sweep_frequency(sweep, 20.0), sweep.high, 1e-12);
}

TEST(TestSignal, GoesWhereItIsNamed) {
  const cueing::AxisLimits limits = cueing::three_axis_limits()[PlatformAxis::kPitch];
  EXPECT_EQ(wanted_position({.signal = TestSignal::kHome}, limits, 3.0), 0.0);
  EXPECT_EQ(wanted_position({.signal = TestSignal::kZero, .position = 0.1}, limits, 3.0), 0.0);
  EXPECT_EQ(wanted_position({.signal = TestSignal::kPose, .position = 0.1}, limits, 3.0), 0.1);
  EXPECT_EQ(wanted_position({.signal = TestSignal::kMax, .size = 1.0}, limits, 3.0), limits.highest);
  EXPECT_EQ(wanted_position({.signal = TestSignal::kMin, .size = 0.5}, limits, 3.0), 0.5 * limits.lowest);
  const TestSignalOptions steps{.signal = TestSignal::kSteps, .size = 1.0, .frequency = 0.25};
  EXPECT_EQ(wanted_position(steps, limits, 0.5), limits.highest);
  EXPECT_EQ(wanted_position(steps, limits, 1.5), 0.0);
  EXPECT_EQ(wanted_position(steps, limits, 2.5), limits.lowest);
  EXPECT_EQ(wanted_position(steps, limits, 3.5), 0.0);
}

TEST(TestSignal, ATiltGivesTheRiderTheForceThatWasAskedFor) {
  for (const auto axis : {cueing::PlatformAxis::kPitch, cueing::PlatformAxis::kRoll}) {
    cueing::PlatformState tilted;
    set_axis(tilted, axis, {.position = tilt_of(axis, 1.5), .rate = 0.0, .acceleration = 0.0});
    const recording::MotionSample felt = rider_motion(tilted);
    EXPECT_NEAR(axis == cueing::PlatformAxis::kPitch ? felt.force.x() : felt.force.y(), 1.5, 1e-12);
  }
  EXPECT_TRUE(std::isnan(tilt_of(cueing::PlatformAxis::kHeave, 1.0)));
  EXPECT_TRUE(std::isnan(tilt_of(cueing::PlatformAxis::kPitch, 10.0)));
}

}  // namespace
}  // namespace veridyn::live
