#include "veridyn/muscle/path/wrap_sphere.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "tests/muscle/path/wrap_checks.hpp"

namespace veridyn::muscle {
namespace {

using Eigen::Vector3d;

TEST(WrapSphere, IsAGreatCircle) {
  const WrapSphere sphere{0.5, {}};
  std::mt19937 random(5);
  int wraps = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p = test::random_point(random, 2.0), q = test::random_point(random, 2.0);
    const WrapResult<double> path = wrap(sphere, p, q);
    if (!path.wrapped() || path.depth > 0.0) continue;
    ++wraps;
    const double angle =
        std::acos(p.normalized().dot(q.normalized())) - std::acos(0.5 / p.norm()) - std::acos(0.5 / q.norm());
    EXPECT_NEAR(path.length, std::sqrt(p.squaredNorm() - 0.25) + std::sqrt(q.squaredNorm() - 0.25) + 0.5 * angle,
                1e-13);
  }
  EXPECT_GT(wraps, 100);
}

TEST(WrapSphere, DerivativesAreThoseOfTheLength) { test::expect_derivatives(WrapSphere{0.02, {}}, 0.02, 1e-8, 1e-4); }

}  // namespace
}  // namespace veridyn::muscle
