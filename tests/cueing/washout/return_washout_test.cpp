#include "veridyn/cueing/washout/return_washout.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/cueing/washout/pushed.hpp"

namespace veridyn::cueing {
namespace {

using testing_support::pushed;

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
