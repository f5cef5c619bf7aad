#include "veridyn/live/virtual/virtual_platform.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::live {
namespace {

using cueing::PlatformAxis;

constexpr Sender kRig{1, 2};

/// Orders of a pitch angle at 100 Hz.
class Orders {
 public:
  PlatformVerdict pitch(VirtualPlatform& platform, double angle, double rate = 0.0) {
    now += 10 * kMillisecond;
    order.sequence += 1;
    order.time = now;
    set_axis(order.motion, PlatformAxis::kPitch, {.position = angle, .rate = rate, .acceleration = 0.0});
    const OrderBytes bytes = encode(order);
    platform.step(now);
    return platform.take({{bytes.data(), bytes.size()}, kRig, now})->verdict;
  }
  PlatformOrder order;
  Nanoseconds now = 0;
};

TEST(VirtualPlatform, CountsOrdersBeyondItsLimitsAndJumps) {
  VirtualPlatform platform(cueing::built_in_platform("three_axis"));
  Orders orders;
  EXPECT_EQ(orders.pitch(platform, 0.0), PlatformVerdict::kFollows);
  EXPECT_EQ(orders.pitch(platform, 0.004), PlatformVerdict::kFollows);
  EXPECT_EQ(platform.counts().jumps, 0U);
  orders.pitch(platform, 0.02);  // 1.6 rad/s; 30 deg/s are allowed
  EXPECT_EQ(platform.counts().jumps, 1U);
  EXPECT_EQ(orders.pitch(platform, 0.4), PlatformVerdict::kOutsideLimits);  // 23 deg of 20
  EXPECT_EQ(orders.pitch(platform, 0.02, 1.0), PlatformVerdict::kOutsideLimits);
  EXPECT_EQ(platform.counts().outside, 2U);
  platform.take({"nonsense", kRig, orders.now});
  EXPECT_EQ(platform.counts().unreadable, 1U);
}

TEST(VirtualPlatform, CountsOrdersThatAskForMoreThanItsAcceleration) {
  VirtualPlatform platform(cueing::built_in_platform("three_axis"));
  Orders orders;
  orders.pitch(platform, 0.0);
  orders.pitch(platform, 0.0001, 0.03);  // 3 rad/s^2; 200 deg/s^2 = 3.49 are allowed
  EXPECT_EQ(platform.counts().too_hard, 0U);
  orders.pitch(platform, 0.0006, 0.07);  // 4 rad/s^2
  EXPECT_EQ(platform.counts().too_hard, 1U);
  EXPECT_EQ(platform.counts().outside + platform.counts().jumps, 0U);
}

TEST(VirtualPlatform, FollowsWithItsActuatorsAndGoesHomeWhereOrdersStop) {
  VirtualPlatform platform(cueing::built_in_platform("three_axis"));
  Orders orders;
  for (int k = 0; k < 200; ++k) orders.pitch(platform, std::min(0.002 * k, 0.1));
  EXPECT_NEAR(axis(platform.reached(), PlatformAxis::kPitch).position, 0.1, 1e-3);
  for (int k = 0; k < 1500; ++k) {
    orders.now += 10 * kMillisecond;
    platform.step(orders.now);
  }
  EXPECT_EQ(platform.counts().silences, 1U);
  EXPECT_NEAR(axis(platform.reached(), PlatformAxis::kPitch).position, 0.0, 1e-3);
}

TEST(VirtualPlatform, DoesNotFollowAnOrderTwice) {
  VirtualPlatform platform(cueing::built_in_platform("three_axis"));
  Orders orders;
  orders.pitch(platform, 0.0);
  orders.pitch(platform, 0.001);
  orders.order.sequence -= 1;
  orders.pitch(platform, 0.002);
  EXPECT_EQ(platform.counts().old, 1U);
  EXPECT_EQ(platform.counts().followed, 2U);
}

}  // namespace
}  // namespace veridyn::live
