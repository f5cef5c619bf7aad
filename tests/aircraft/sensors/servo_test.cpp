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

}  // namespace
}  // namespace veridyn::aircraft
