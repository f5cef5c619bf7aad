#include "veridyn/muscle/path/wrap_torus.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/muscle/path/wrap_checks.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {
namespace {

using Eigen::Vector3d;

TEST(WrapTorus, ThroughTheHoleIsStationaryAlongTheRing) {
  const WrapTorus torus{0.005, 0.03, {}};
  const Vector3d p(0.05, 0.004, 0.04), q(0.055, -0.01, -0.05);
  const WrapResult<double> path = wrap(torus, p, q);
  ASSERT_TRUE(path.wrapped());
  EXPECT_GT(path.length, (q - p).norm());
  EXPECT_NEAR(internal::tube_slope<double>(path, p, q), 0.0, 1e-9);
  // In a plane through the axis the tube is a circle.
  const Vector3d a(0.05, 0.0, 0.04), b(0.05, 0.0, -0.04);
  const double u = 0.02, d = std::hypot(u, 0.04);
  const double angle = 2.0 * (kPi - std::atan2(0.04, u) - std::acos(0.005 / d));
  EXPECT_NEAR(wrap(torus, a, b).length, 2.0 * std::sqrt(d * d - 0.005 * 0.005) + 0.005 * angle, 1e-9);
  EXPECT_FALSE(wrap(torus, Vector3d(0.0, 0.0, 0.04), Vector3d(0.001, 0.0, -0.04)).wrapped());
  test::expect_derivatives(torus, 0.03, 1e-5, 1e-2, 20);
}

}  // namespace
}  // namespace veridyn::muscle
