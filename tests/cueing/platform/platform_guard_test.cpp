#include "veridyn/cueing/platform/platform_guard.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::cueing {
namespace {

/// A platform that only heaves and pitches.
PlatformLimits two_axes() {
  PlatformLimits limits = three_axis_limits();
  limits[PlatformAxis::kRoll] = {};
  return limits;
}

TEST(PlatformGuard, LeadsEachAxisAsItsOwnGuardAndHoldsTheOthers) {
  PlatformGuard guard(two_axes());
  AxisGuard heave(two_axes()[PlatformAxis::kHeave]);
  (void)guard.reset();
  (void)heave.reset(0.0);
  for (int k = 0; k < 400; ++k) {
    PlatformCommand desired;
    desired.shift = {0.3, -0.2, 0.08 * std::sin(0.03 * k)};
    desired.angle = {0.2, k < 200 ? 0.1 : 5.0, 0.1};
    const PlatformState s = guard.step(desired, 0.01);
    const AxisState alone = heave.step(desired.shift.z(), 0.01);
    ASSERT_EQ(s.shift.z(), alone.position);
    ASSERT_EQ(s.velocity.z(), alone.rate);
    for (const PlatformAxis still :
         {PlatformAxis::kSurge, PlatformAxis::kSway, PlatformAxis::kRoll, PlatformAxis::kYaw})
      ASSERT_EQ(axis(s, still).position, 0.0);
    // Pitch cannot jump; the axes that cannot move at all are not held back by a limit.
    if (k == 201 || k == 210 || k == 399) {
      EXPECT_EQ(guard.limited().to_ulong(), 1U << static_cast<unsigned>(PlatformAxis::kPitch));
    }
  }
  // Pitch was asked for more than its range, and is at its end.
  EXPECT_NEAR(guard.state().angle.y(), two_axes()[PlatformAxis::kPitch].highest, 1e-8);
}

TEST(PlatformGuard, BeginsWithinItsLimitsAndBrakesEveryAxis) {
  PlatformGuard guard(two_axes());
  PlatformCommand far;
  far.shift.z() = -3.0;
  far.angle = {1.0, 1.0, 1.0};
  const PlatformState begun = guard.reset(far);
  EXPECT_NEAR(begun.shift.z(), two_axes()[PlatformAxis::kHeave].lowest, 1e-6);
  EXPECT_NEAR(begun.angle.y(), two_axes()[PlatformAxis::kPitch].highest, 1e-6);
  EXPECT_EQ(begun.angle.x(), 0.0);
  PlatformCommand back;
  for (int k = 0; k < 10; ++k) (void)guard.step(back, 0.01);
  EXPECT_GT(guard.state().velocity.z(), 0.01);
  EXPECT_LT(guard.state().rate.y(), -0.01);
  for (int k = 0; k < 200; ++k) (void)guard.brake(0.01);
  EXPECT_NEAR(guard.state().velocity.z(), 0.0, 1e-9);
  EXPECT_NEAR(guard.state().rate.y(), 0.0, 1e-9);
}

}  // namespace
}  // namespace veridyn::cueing
