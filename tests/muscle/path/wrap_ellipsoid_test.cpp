#include "veridyn/muscle/path/wrap_ellipsoid.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "tests/muscle/path/wrap_checks.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/path/wrap_sphere.hpp"

namespace veridyn::muscle {
namespace {

using Eigen::Vector3d;

TEST(WrapEllipsoid, OfEqualRadiiIsTheSphere) {
  std::mt19937 random(11);
  int wraps = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p = test::random_point(random, 1.0), q = test::random_point(random, 1.0);
    const WrapResult<double> s = wrap(WrapSphere{0.5, {}}, p, q);
    const WrapResult<double> e = wrap(WrapEllipsoid{{0.5, 0.5, 0.5}, {}}, p, q);
    ASSERT_EQ(s.status, e.status) << p.transpose() << " | " << q.transpose();
    if (!s.wrapped()) continue;
    ++wraps;
    EXPECT_NEAR(s.length, e.length, 1e-6);
    if (s.spread > 0.3 && s.depth == 0.0) {
      EXPECT_NEAR((s.r1 - e.r1).norm(), 0.0, 1e-4);
    }
  }
  EXPECT_GT(wraps, 100);
}

TEST(WrapEllipsoid, InAPlaneOfSymmetryIsTheEllipse) {
  const Vector3d radii(0.035, 0.02, 0.025);
  const Vector3d p(-0.05, 0.012, 0.0), q(0.045, 0.018, 0.0);
  const WrapResult<double> path = wrap(WrapEllipsoid{radii, {}}, p, q);
  ASSERT_TRUE(path.wrapped());
  EXPECT_NEAR(path.r1.z(), 0.0, 1e-12);
  // Tangent points of the ellipse in closed form (in x / a it is the unit circle), the arc by a fine polygon.
  const auto tangent = [&](const Vector3d& x, double sign) {
    const double u = x.x() / radii.x(), v = x.y() / radii.y();
    return std::atan2(v, u) + sign * std::acos(1.0 / std::hypot(u, v));
  };
  const double t1 = tangent(p, -1.0), t2 = tangent(q, 1.0);
  const auto at = [&](double t) { return Vector3d(radii.x() * std::cos(t), radii.y() * std::sin(t), 0.0); };
  double arc = 0.0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) arc += (at(t1 + (t2 - t1) * (i + 1) / n) - at(t1 + (t2 - t1) * i / n)).norm();
  EXPECT_NEAR(path.surface_length, arc, 1e-9);
  EXPECT_NEAR(path.length, (at(t1) - p).norm() + arc + (q - at(t2)).norm(), 1e-9);
}

TEST(WrapEllipsoid, OnASpheroidKeepsClairautsConstantAndIsNoLongerThanAnyPlaneSection) {
  const Vector3d radii(0.035, 0.02, 0.02);
  std::mt19937 random(19);
  int wraps = 0;
  for (int i = 0; i < 3000 && wraps < 150; ++i) {
    const Vector3d p = test::random_point(random, 0.06), q = test::random_point(random, 0.06);
    const WrapResult<double> path = wrap(WrapEllipsoid{radii, {}}, p, q);
    if (!path.wrapped() || path.depth > 0.0) continue;
    ++wraps;
    EXPECT_NEAR(path.r1.cross(path.direction1).x(), path.r2.cross(path.direction2).x(), 2e-7)
        << p.transpose() << " | " << q.transpose();
    const auto normal = [&](const Vector3d& x) {
      return Vector3d(x.cwiseQuotient(radii.cwiseProduct(radii)).normalized());
    };
    // The accuracy that the header promises.
    EXPECT_NEAR(path.direction1.dot(normal(path.r1)), 0.0, 1e-5);
    EXPECT_NEAR(path.direction2.dot(normal(path.r2)), 0.0, 1e-5);
    // Sections by planes through P and Q: in x / a a circle, tangents and arc as above.
    double best = 1e9;
    const Vector3d ps = p.cwiseQuotient(radii), qs = q.cwiseQuotient(radii), line = (qs - ps).normalized();
    for (int k = 0; k < 180; ++k) {
      const Vector3d n = Eigen::AngleAxisd(kPi * k / 180.0, line) * line.unitOrthogonal();
      const Vector3d center = n * n.dot(ps);
      const double radius2 = 1.0 - center.squaredNorm();
      if (radius2 <= 0.0) continue;
      const double radius = std::sqrt(radius2);
      const Vector3d u = ps - center, v = qs - center;
      if (u.norm() < radius || v.norm() < radius) continue;
      const double total = std::acos(std::clamp(u.normalized().dot(v.normalized()), -1.0, 1.0));
      const double b1 = std::acos(radius / u.norm()), b2 = std::acos(radius / v.norm());
      if (total < b1 + b2) continue;
      const Vector3d e1 = u.normalized(), e2 = (v - e1 * v.dot(e1)).normalized();
      const auto at = [&](double t) {
        return Vector3d((center + radius * (std::cos(t) * e1 + std::sin(t) * e2)).cwiseProduct(radii));
      };
      double arc = 0.0;
      for (int j = 0; j < 200; ++j)
        arc += (at(b1 + (total - b1 - b2) * (j + 1) / 200) - at(b1 + (total - b1 - b2) * j / 200)).norm();
      best = std::min(best, (at(b1) - p).norm() + arc + (q - at(total - b2)).norm());
    }
    if (best < 1e8) {
      EXPECT_LT(path.length, best + 2e-6);
      // Planes come close to the geodesic unless the wrap is deep.
      if (path.spread > 0.6) {
        EXPECT_GT(path.length, best - 4e-4);
      }
    }
  }
  EXPECT_GE(wraps, 100);
}

TEST(WrapEllipsoid, DerivativesAreThoseOfTheLength) {
  test::expect_derivatives(WrapEllipsoid{{0.035, 0.02, 0.02}, {}}, 0.02, 3e-5, 1e-3);
  test::expect_derivatives(WrapEllipsoid{{0.025, 0.03, 0.018}, {}}, 0.02, 3e-5, 1e-3);
}

TEST(WrapEllipsoid, ReleasesContinuouslyWhereAnEndDipsIn) {
  const WrapEllipsoid ellipsoid{{0.025, 0.02, 0.02}, {}};
  const Vector3d q(0.03, 0.004, 0.002);
  double before = -1.0, before_change = 0.0;
  for (double x = -0.027; x < -0.0235; x += 1e-6) {
    const Vector3d p(x, 0.002, 0.001);
    const WrapResult<double> r = wrap(ellipsoid, p, q);
    ASSERT_NE(r.status, WrapStatus::kFailed);
    const double straight = (q - p).norm();
    const double length = r.wrapped() ? r.length : straight;
    if (before > 0.0) {
      EXPECT_NEAR(length, before, 6e-5) << x;
    }
    before_change = length - before;
    before = length;
  }
  EXPECT_LT(std::abs(before_change), 1e-5);
}

}  // namespace
}  // namespace veridyn::muscle
