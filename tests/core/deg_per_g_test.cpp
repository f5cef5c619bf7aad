#include "veridyn/core/deg_per_g.hpp"

#include <gtest/gtest.h>

namespace veridyn {
namespace {

TEST(DegPerG, IsDegreesAtTheAccelerationOfGravity) {
  // 0.05 rad of steer at 1 g are 2.864789 deg.
  EXPECT_NEAR(deg_per_g(0.05 / 9.80665), 2.8647889756541160, 1e-14);
  EXPECT_EQ(deg_per_g(0.0), 0.0);
  EXPECT_LT(deg_per_g(-1e-3), 0.0);
}

}  // namespace
}  // namespace veridyn
