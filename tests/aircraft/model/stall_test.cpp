#include "veridyn/aircraft/model/stall.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::aircraft {
namespace {

TEST(StallBlend, IsThePublishedSigmoidWhereThatCanBeComputed) {
  const double M = 50, a0 = 0.4712;
  for (double a = -0.9; a <= 0.9; a += 0.01) {
    const double e1 = std::exp(-M * (a - a0)), e2 = std::exp(M * (a + a0));
    EXPECT_NEAR(separated_share(a, M, a0), (1 + e1 + e2) / ((1 + e1) * (1 + e2)), 1e-13);
  }
  // Straight from the formula these overflow: exp(800) is infinite.
  EXPECT_DOUBLE_EQ(separated_share(1.57, 1000.0, 0.3), 1.0);
  EXPECT_DOUBLE_EQ(separated_share(-1.57, 1000.0, 0.3), 1.0);
  EXPECT_LT(separated_share(0.0, 1000.0, 0.3), 1e-100);
  EXPECT_GT(separated_share(0.0, 1000.0, 0.3), 0.0);
  EXPECT_NEAR(separated_share(0.4712, 50.0, 0.4712), 0.5, 1e-15);
}

}  // namespace
}  // namespace veridyn::aircraft
