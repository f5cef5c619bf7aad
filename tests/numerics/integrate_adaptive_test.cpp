#include "tests/support/integrate_adaptive.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::numerics {
namespace {

// x'' = -x + cos(2 t): closed form x = (4/3) cos t - (1/3) cos 2t for x(0) = 1, x'(0) = 0.
TEST(IntegrateAdaptive, KeepsTheToleranceAndReachesTheEndInBothDirections) {
  const OdeFunction f = [](double t, const Eigen::VectorXd& x, Eigen::VectorXd& rate) {
    rate = Eigen::Vector2d(x(1), -x(0) + std::cos(2 * t));
  };
  const double exact = 4.0 / 3.0 * std::cos(20.0) - std::cos(40.0) / 3.0;
  for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
    const IntegrationOptions options{.absolute_tolerance = tolerance, .relative_tolerance = tolerance};
    const IntegrationResult r = integrate_adaptive(f, Eigen::Vector2d(1, 0), 0.0, 20.0, options);
    ASSERT_TRUE(r.usable());
    EXPECT_DOUBLE_EQ(r.time, 20.0);
    EXPECT_LT(std::abs(r.state(0) - exact), 100 * tolerance);  // global error over about 20 time constants
    const IntegrationResult back = integrate_adaptive(f, r.state, 20.0, 0.0, options);
    ASSERT_TRUE(back.usable());
    EXPECT_NEAR(back.state(0), 1.0, 300 * tolerance);
  }
}

}  // namespace
}  // namespace veridyn::numerics
