#include "veridyn/cueing/washout/fuzzy_washout.hpp"

#include <gtest/gtest.h>

namespace veridyn::cueing {
namespace {

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

}  // namespace
}  // namespace veridyn::cueing
