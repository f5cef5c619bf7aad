#include "veridyn/muscle/actuator/damped_velocity.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::muscle {
namespace {

// With fV(v) = 1 + v the balance A (1 + v) + damping v = F is linear: v = (F - A)/(A + damping).
TEST(DampedVelocity, SolvesTheLinearBalanceInItsFirstSteps) {
  const auto curve = [](double v) { return numerics::FunctionValue<double>{1.0 + v, 1.0, 0.0}; };
  for (const double F : {0.1, 0.5, 1.4}) {
    const DampedVelocity begin{0.5, F, 0.1, -2.0, 2.0, 0.3};
    EXPECT_NEAR(damped_velocity(0.5, F, begin, curve), (F - 0.5) / 0.6, 1e-14) << F;
  }
}

TEST(DampedVelocity, StaysInsideItsBracketWhereAStepWouldLeaveIt) {
  // A steep arctangent: Halley's step from the flat part leaves [-1, 1].
  const auto curve = [](double v) {
    const double u = 40.0 * v, w = 1.0 + u * u;
    return numerics::FunctionValue<double>{std::atan(u), 40.0 / w, -3200.0 * u / (w * w)};
  };
  DampedVelocity solution{1.0, -1.2, 1e-3, -1.0, 1.0, 0.9};
  for (int i = 0; i < 100 && !solution.done; ++i) {
    solution.iterate(curve);
    ASSERT_GE(solution.v, -1.0);
    ASSERT_LE(solution.v, 1.0);
  }
  EXPECT_TRUE(solution.done);
  EXPECT_NEAR(std::atan(40.0 * solution.v) + 1e-3 * solution.v, -1.2, 1e-12);
}

}  // namespace
}  // namespace veridyn::muscle
