// What distinguishes the algorithms whose gains or origin move.

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/cueing/washout/adaptive_washout.hpp"
#include "veridyn/cueing/washout/fuzzy_washout.hpp"
#include "veridyn/cueing/washout/moving_origin_washout.hpp"
#include "veridyn/cueing/washout/return_washout.hpp"

namespace veridyn::cueing {
namespace {

recording::MotionSample pushed(double forward) {
  recording::MotionSample s;
  s.frame = Frame::kFrd;
  s.force = recording::force_at_rest(Frame::kFrd) + Eigen::Vector3d(forward, 0.0, 0.0);
  return s;
}

TEST(AdaptiveWashout, GainsFallUnderStrongMotionAndReturnToNominal) {
  AdaptiveWashout washout(AdaptiveDesign{}, built_in_platform("hexapod"));
  washout.reset(pushed(0.0));
  double least = 1.0;
  for (int k = 0; k < 2000; ++k) {
    washout.step(pushed(6.0 * std::sin(0.008 * k)), 0.01);
    least = std::min(least, washout.gains()[1](0));
    ASSERT_GE(washout.gains()[1].minCoeff(), 0.0);
    ASSERT_LE(washout.gains()[1].maxCoeff(), 2.0);
  }
  EXPECT_LT(least, 0.7);
  for (int k = 0; k < 3000; ++k) washout.step(pushed(0.0), 0.01);
  EXPECT_NEAR(washout.gains()[1](0), 1.0, 0.01);
  EXPECT_NEAR(washout.gains()[1](1), 1.0, 0.01);
}

TEST(FuzzyGain, FallsAsTheRoomIsUsedUp) {
  EXPECT_EQ(fuzzy_gain(0.0, 0.0, 1.4, 0.3), 1.4);
  EXPECT_NEAR(fuzzy_gain(1.0, 2.0, 1.4, 0.3), 0.3, 1e-12);
  EXPECT_NEAR(fuzzy_gain(5.0, 20.0, 1.4, 0.3), 0.3, 1e-12);
  for (double used = 0.0; used < 1.0; used += 0.05) {
    for (double speed = -1.0; speed < 2.0; speed += 0.1) {
      EXPECT_LE(fuzzy_gain(used + 0.05, speed, 1.4, 0.3), fuzzy_gain(used, speed, 1.4, 0.3) + 1e-12);
      EXPECT_LE(fuzzy_gain(used, speed + 0.1, 1.4, 0.3), fuzzy_gain(used, speed, 1.4, 0.3) + 1e-12);
    }
  }
}

TEST(MovingOriginWashout, MakesRoomOnTheOtherSideOfAStrongPush) {
  MovingOriginWashout washout(MovingOriginDesign{}, built_in_platform("hexapod"));
  washout.reset(pushed(0.0));
  for (int k = 0; k < 150; ++k) washout.step(pushed(5.0), 0.01);
  EXPECT_LT(washout.origin().x(), -0.005);
  for (int k = 0; k < 6000; ++k) washout.step(pushed(0.0), 0.01);
  EXPECT_NEAR(washout.origin().x(), 0.0, 1e-4);
  MovingOriginWashout calm(MovingOriginDesign{}, built_in_platform("hexapod"));
  calm.reset(pushed(0.0));
  for (int k = 0; k < 300; ++k) calm.step(pushed(0.2), 0.01);
  EXPECT_EQ(calm.origin().x(), 0.0);
}

TEST(ReturnWashout, ComesHomeBelowThresholdWithoutBeingFelt) {
  ReturnWashout washout(ReturnDesign{}, built_in_platform("hexapod"));
  washout.reset(pushed(0.0));
  PlatformCommand c;
  for (int k = 0; k < 25; ++k) c = washout.step(pushed(2.5), 0.01);
  double most = 0.0, away = 0.0;
  for (int k = 0; k < 1000; ++k) {
    c = washout.step(pushed(0.0), 0.01);
    if (k > 60) most = std::max(most, std::abs(c.acceleration.x()));  // what was pushed comes to its end
    away = std::max(away, std::abs(c.shift.x()));
  }
  EXPECT_GT(away, 0.1);
  EXPECT_LE(most, 0.15 + 1e-9);
  EXPECT_LT(std::abs(c.shift.x()), 0.005);
}

TEST(ReturnWashout, BrakesALongPushWithinTheRange) {
  ReturnWashout washout(ReturnDesign{}, built_in_platform("hexapod"));
  washout.reset(pushed(0.0));
  PlatformCommand c;
  double away = 0.0;
  for (int k = 0; k < 2000; ++k) {
    c = washout.step(pushed(k < 70 ? 2.5 : 0.0), 0.01);
    away = std::max(away, std::abs(c.shift.x()));
  }
  EXPECT_GT(away, 0.25);
  EXPECT_LT(away, 0.5);
  EXPECT_LT(std::abs(c.shift.x()), 0.01);
}

}  // namespace
}  // namespace veridyn::cueing
