#include "veridyn/cueing/washout/adaptive_washout.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/cueing/washout/pushed.hpp"

namespace veridyn::cueing {
namespace {

using testing_support::pushed;

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

}  // namespace
}  // namespace veridyn::cueing
