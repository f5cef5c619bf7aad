#include "veridyn/aircraft/sensors/servo.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::aircraft {
namespace {

TEST(Servo, FollowsAStepAsItsClosedFormSays) {
  const Actuator a{.lower = -1, .upper = 1, .time_constant = 0.05, .delay = 0.01};
  Servo servo(a, 0.0, 0.0025);
  for (int k = 1; k <= 100; ++k) {
    servo.advance(0.5);
    const double t = 0.0025 * k - 0.01;
    EXPECT_NEAR(servo.position(), t > 0 ? 0.5 * (1 - std::exp(-t / 0.05)) : 0.0, 1e-12);
  }
  Servo fast({.lower = -1, .upper = 0.3, .rate_limit = 2.0}, 0.0, 0.0025);
  for (int k = 1; k <= 100; ++k) {
    fast.advance(5.0);
    EXPECT_NEAR(fast.position(), std::min(0.3, 2.0 * 0.0025 * k), 1e-12);
  }
}

// A triangle of amplitude 0.1 through a play of 0.04: after a reversal the surface waits until the servo has gone 0.04,
// then follows 0.02 behind.
TEST(Servo, TakesUpThePlayAfterAReversal) {
  Servo servo({.lower = -1, .upper = 1, .free_play = 0.04}, 0.0, 0.0025);
  const auto triangle = [](int k) { return 0.001 * (k % 400 < 200 ? k % 400 - 100 : 300 - k % 400); };
  for (int k = 200; k < 1400; ++k) {
    servo.advance(triangle(k));
    if (k < 600) continue;
    const int since = k % 200;  // the reversal at +-0.1
    const double forward = k % 400 < 200 ? 1.0 : -1.0;
    const double expected = since < 40 ? -0.08 * forward : triangle(k) - 0.02 * forward;
    EXPECT_NEAR(servo.position(), expected, 1e-12) << k;
  }
}

}  // namespace
}  // namespace veridyn::aircraft
