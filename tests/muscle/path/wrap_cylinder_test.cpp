#include "veridyn/muscle/path/wrap_cylinder.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "tests/muscle/path/wrap_checks.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {
namespace {

using Eigen::Vector3d;

TEST(WrapCylinder, IsTheClosedFormOfASymmetricWrap) {
  const double r = 0.02, x = 0.05;
  const WrapCylinder cylinder{r, 0.1, {}};
  const WrapResult<double> path = wrap(cylinder, Vector3d(-x, 0.01, 0.0), Vector3d(x, 0.01, 0.0));
  ASSERT_TRUE(path.wrapped());
  const double distance = std::hypot(x, 0.01);
  const double angle = 2.0 * (std::atan2(x, 0.01) - std::acos(r / distance));
  EXPECT_NEAR(path.length, 2.0 * std::sqrt(distance * distance - r * r) + r * angle, 1e-15);
  EXPECT_GT(path.r1.y(), 0.0);  // the shorter way
  EXPECT_FALSE(wrap(cylinder, Vector3d(-x, 0.021, 0.0), Vector3d(x, 0.021, 0.0)).wrapped());
}

TEST(WrapCylinder, NoNeighbouringTangentPointsMakeAShorterPath) {
  std::mt19937 random(3);
  const WrapCylinder cylinder{0.5, 10.0, {}};
  int wraps = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p = test::random_point(random, 2.0), q = test::random_point(random, 2.0);
    const WrapResult<double> path = wrap(cylinder, p, q);
    if (!path.wrapped() || path.depth > 0.0) continue;
    ++wraps;
    const double a1 = std::atan2(path.r1.y(), path.r1.x()), a2 = std::atan2(path.r2.y(), path.r2.x());
    const auto length = [&](double da1, double dz1, double da2, double dz2) {
      const Vector3d r1(0.5 * std::cos(a1 + da1), 0.5 * std::sin(a1 + da1), path.r1.z() + dz1);
      const Vector3d r2(0.5 * std::cos(a2 + da2), 0.5 * std::sin(a2 + da2), path.r2.z() + dz2);
      const double arc = std::abs(std::remainder(a2 + da2 - a1 - da1, 2.0 * kPi));
      return (r1 - p).norm() + std::hypot(0.5 * arc, r2.z() - r1.z()) + (q - r2).norm();
    };
    EXPECT_NEAR(length(0, 0, 0, 0), path.length, 1e-13);
    // Away from ends close to the surface and from short arcs, where the length bends sharply.
    if ((path.r1 - p).norm() < 0.2 || (path.r2 - q).norm() < 0.2 || path.surface_length < 0.2) continue;
    const double h = 1e-4;
    EXPECT_GT(length(0, h, 0, 0), path.length);
    EXPECT_GT(length(0, -h, 0, h), path.length);
    EXPECT_NEAR(length(0, h, 0, 0), length(0, -h, 0, 0), 1e-9);
    EXPECT_NEAR(length(h, 0, 0, 0), length(-h, 0, 0, 0), 1e-9);
    EXPECT_NEAR(length(0, 0, h, 0), length(0, 0, -h, 0), 1e-9);
    EXPECT_NEAR(length(0, 0, 0, h), length(0, 0, 0, -h), 1e-9);
  }
  EXPECT_GT(wraps, 200);
}

TEST(WrapCylinder, AQuadrantSendsThePathTheLongWayRound) {
  const WrapCylinder cylinder{0.02, 0.1, {1, 1}};  // +y
  const Vector3d p(-0.05, -0.03, 0.0), q(0.05, -0.03, 0.0);
  // The segment passes below and misses; a wall below the axis makes it go over the top.
  const WrapResult<double> path = wrap(cylinder, p, q);
  ASSERT_TRUE(path.wrapped());
  EXPECT_FALSE(path.meets);
  EXPECT_GT(path.length, 0.14);
  EXPECT_FALSE(wrap(cylinder, Vector3d(-0.05, 0.03, 0.0), Vector3d(0.05, 0.03, 0.0)).wrapped());
  // It lets go continuously as an end rises.
  double before = path.length;
  for (double y = -0.03; y < 0.06; y += 1e-4) {
    const Vector3d end(0.05, y, 0.0);
    const WrapResult<double> now = wrap(cylinder, p, end);
    const double length = now.wrapped() ? now.length : (end - p).norm();
    EXPECT_NEAR(length, before, 2e-4) << y;
    before = length;
  }
}

/// The path's length as it comes off the end, and its slopes.
struct Coming {
  double length = 0.0;
  Vector3d by_p = Vector3d::Zero(), by_q = Vector3d::Zero();
  bool letting_go = false;
};

Coming coming_off(const WrapCylinder& cylinder, const Vector3d& p, const Vector3d& q) {
  const Vector3d along = (q - p).normalized();
  Coming path{(q - p).norm(), -along, along, false};
  const WrapResult<double> r = wrap(cylinder, p, q);
  if (!r.wrapped()) return path;
  const double detour = r.length - path.length;
  path.letting_go = r.weight < 1.0;
  path.by_p += r.weight * (r.gradient_p - path.by_p) + detour * r.weight_p;
  path.by_q += r.weight * (r.gradient_q - path.by_q) + detour * r.weight_q;
  path.length += r.weight * detour;
  return path;
}

TEST(WrapCylinder, LetsGoBeyondItsEnds) {
  const WrapCylinder cylinder{0.02, 0.05, {}};
  double before = -1.0;
  for (double z = 0.03; z < 0.08; z += 1e-5) {
    const Vector3d p(-0.05, 0.001, z), q(0.05, 0.001, z);
    const Coming path = coming_off(cylinder, p, q);
    if (before > 0.0) {
      EXPECT_NEAR(path.length, before, 1.2e-5);
    }
    before = path.length;
    if (z < 0.0519) {
      EXPECT_FALSE(path.letting_go);
      EXPECT_EQ(path.length, wrap(cylinder, p, q).length);
    }
    if (z > 0.066) {
      EXPECT_FALSE(wrap(cylinder, p, q).wrapped());
    }
  }
}

TEST(WrapCylinder, SlopesOfAPathThatComesOffAnEndAreThoseOfItsLengthAndBounded) {
  std::mt19937 random(11);
  for (const WrapCylinder& cylinder : {WrapCylinder{0.02, 0.03, {}}, WrapCylinder{0.02, 0.03, {0, -1}}}) {
    int letting_go = 0, dipping = 0;
    for (int i = 0; i < 20000; ++i) {
      Vector3d p = test::random_point(random, 0.06), q = test::random_point(random, 0.06);
      p.z() = 0.04 + 0.3 * p.z();
      q.z() = 0.04 + 0.3 * q.z();
      const double near = std::min(std::hypot(p.x(), p.y()), std::hypot(q.x(), q.y()));
      // Where an end comes to the surface or the axis, and at a quadrant's wall, slopes bend or jump.
      if (std::abs(near - 0.02) < 1e-3 || near < 4e-3 || std::abs(p.y()) < 1e-4 || std::abs(q.y()) < 1e-4) continue;
      const Coming here = coming_off(cylinder, p, q);
      if (!here.letting_go) continue;
      ++letting_go;
      dipping += near < 0.02 ? 1 : 0;
      if (near > 0.02) {
        EXPECT_LT(here.by_p.norm(), 6.0) << p.transpose() << " | " << q.transpose();
        EXPECT_LT(here.by_q.norm(), 6.0) << p.transpose() << " | " << q.transpose();
      }
      for (int k = 0; k < 6; ++k) {
        const Vector3d step = Vector3d::Unit(k % 3) * 1e-7;
        const auto length = [&](double times) {
          return k < 3 ? coming_off(cylinder, p + times * step, q).length
                       : coming_off(cylinder, p, q + times * step).length;
        };
        const double slope = (8.0 * (length(1.0) - length(-1.0)) - (length(2.0) - length(-2.0))) / 12e-7;
        EXPECT_NEAR(slope, k < 3 ? here.by_p[k] : here.by_q[k - 3], 1e-6) << p.transpose() << " | " << q.transpose();
      }
    }
    EXPECT_GT(letting_go, 1000);
    EXPECT_GT(dipping, 300);
  }
}

TEST(WrapCylinder, DerivativesAreThoseOfTheLength) {
  test::expect_derivatives(WrapCylinder{0.02, 0.5, {}}, 0.02, 1e-8, 1e-4);
  test::expect_derivatives(WrapCylinder{0.02, 0.5, {0, -1}}, 0.02, 1e-8, 1e-4);
}

}  // namespace
}  // namespace veridyn::muscle
