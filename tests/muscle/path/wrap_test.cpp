#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/path/wrap_cylinder.hpp"
#include "veridyn/muscle/path/wrap_ellipsoid.hpp"
#include "veridyn/muscle/path/wrap_opensim.hpp"
#include "veridyn/muscle/path/wrap_sphere.hpp"
#include "veridyn/muscle/path/wrap_torus.hpp"

namespace veridyn::muscle {
namespace {

using Eigen::Vector3d;

Vector3d random_point(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> u(-size, size);
  const double x = u(random), y = u(random);
  return {x, y, u(random)};
}

/// Gradients against differences of lengths, and the gradients of Jets against differences of gradients.
template <typename Object>
void expect_derivatives(const Object& object, double size, double gradient_tolerance, double curvature_tolerance,
                        int at_least = 200) {
  std::mt19937 random(7);
  int wraps = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d p = random_point(random, 2.5 * size), q = random_point(random, 2.5 * size);
    const WrapResult<double> r = wrap(object, p, q);
    if (!r.wrapped() || r.weight < 1.0 || r.spread < 0.2) continue;
    // Next to the surface lengths bend too sharply for differences of this step.
    if ((r.r1 - p).norm() < 0.3 * size || (r.r2 - q).norm() < 0.3 * size) continue;
    using Jet = ceres::Jet<double, 6>;
    Eigen::Matrix<Jet, 3, 1> pj, qj;
    for (int k = 0; k < 3; ++k) {
      pj[k] = Jet(p[k], k);
      qj[k] = Jet(q[k], 3 + k);
    }
    const WrapResult<Jet> rj = wrap(object, pj, qj);
    const double h = 1e-6 * size;
    bool smooth = true;
    for (int k = 0; k < 6 && smooth; ++k) {
      Vector3d p1 = p, p2 = p, q1 = q, q2 = q;
      (k < 3 ? p1[k] : q1[k - 3]) += h;
      (k < 3 ? p2[k] : q2[k - 3]) -= h;
      const WrapResult<double> r1 = wrap(object, p1, q1), r2 = wrap(object, p2, q2);
      smooth = r1.wrapped() && r2.wrapped();
      if (!smooth) break;
      const double gradient = k < 3 ? r.gradient_p[k] : r.gradient_q[k - 3];
      EXPECT_NEAR((r1.length - r2.length) / (2.0 * h), gradient, gradient_tolerance)
          << p.transpose() << " | " << q.transpose();
      EXPECT_NEAR(rj.length.v[k], gradient, gradient_tolerance);
      for (int m = 0; m < 3; ++m) {
        const double difference = (r1.gradient_p[m] - r2.gradient_p[m]) / (2.0 * h) * size;
        EXPECT_NEAR(rj.gradient_p[m].v[k] * size, difference, curvature_tolerance * (1.0 + std::abs(difference)));
      }
    }
    wraps += smooth ? 1 : 0;
  }
  EXPECT_GT(wraps, at_least);
}

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
    const Vector3d p = random_point(random, 2.0), q = random_point(random, 2.0);
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

TEST(WrapCylinder, FadesOutBeyondItsEndsAndWhereAnEndDipsIn) {
  const WrapCylinder cylinder{0.02, 0.05, {}};
  double before = -1.0;
  for (double z = 0.03; z < 0.08; z += 1e-5) {
    const Vector3d p(-0.05, 0.001, z), q(0.05, 0.001, z);
    const WrapResult<double> r = wrap(cylinder, p, q);
    const double straight = (q - p).norm();
    const double length = r.wrapped() ? straight + r.weight * (r.length - straight) : straight;
    if (before > 0.0) {
      EXPECT_NEAR(length, before, 3e-5);
    }
    before = length;
    if (z < 0.0519) {
      EXPECT_EQ(r.weight, 1.0);
    }
    if (z > 0.0621) {
      EXPECT_FALSE(r.wrapped());
    }
  }
  const Vector3d q(0.05, 0.001, 0.0);
  EXPECT_LT(wrap(cylinder, Vector3d(-0.0198, 0.0, 0.0), q).weight, 1.0);
  EXPECT_EQ(wrap(cylinder, Vector3d(-0.015, 0.0, 0.0), q).status, WrapStatus::kInside);
}

TEST(WrapCylinder, DerivativesAreThoseOfTheLength) {
  expect_derivatives(WrapCylinder{0.02, 0.5, {}}, 0.02, 1e-8, 1e-4);
  expect_derivatives(WrapCylinder{0.02, 0.5, {0, -1}}, 0.02, 1e-8, 1e-4);
}

TEST(WrapSphere, IsAGreatCircle) {
  const WrapSphere sphere{0.5, {}};
  std::mt19937 random(5);
  int wraps = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p = random_point(random, 2.0), q = random_point(random, 2.0);
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

TEST(WrapSphere, DerivativesAreThoseOfTheLength) { expect_derivatives(WrapSphere{0.02, {}}, 0.02, 1e-8, 1e-4); }

TEST(WrapEllipsoid, OfEqualRadiiIsTheSphere) {
  std::mt19937 random(11);
  int wraps = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p = random_point(random, 1.0), q = random_point(random, 1.0);
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
    const Vector3d p = random_point(random, 0.06), q = random_point(random, 0.06);
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
  expect_derivatives(WrapEllipsoid{{0.035, 0.02, 0.02}, {}}, 0.02, 3e-5, 1e-3);
  expect_derivatives(WrapEllipsoid{{0.025, 0.03, 0.018}, {}}, 0.02, 3e-5, 1e-3);
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
    const double length = r.wrapped() ? straight + r.weight * (r.length - straight) : straight;
    if (before > 0.0) {
      EXPECT_NEAR(length, before, 6e-5) << x;
    }
    before_change = length - before;
    before = length;
  }
  EXPECT_LT(std::abs(before_change), 1e-5);
}

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
  expect_derivatives(torus, 0.03, 1e-5, 1e-2, 20);
}

/// Quadrature on the auxiliary sphere against Nystroem steps along the geodesic: end, direction, Jacobi field.
TEST(WrapEllipsoid, ASpheroidsGeodesicIsTheIntegratedOne) {
  for (const Vector3d& a : {Vector3d(0.035, 0.02, 0.02), Vector3d(0.02, 0.02, 0.012), Vector3d(0.02, 0.02, 0.02)}) {
    const internal::Spheroid shape = internal::spheroid(a);
    ASSERT_GE(shape.axis, 0);
    for (int i = 0; i < 20; ++i) {
      const Vector3d u(std::sin(1.0 + i), std::cos(2.3 * i), std::sin(0.7 * i + 2.0));
      const Vector3d r1 = u.normalized().cwiseProduct(a);
      const Vector3d n1 = r1.cwiseQuotient(a.cwiseProduct(a));
      // The first along the equator, where the auxiliary sphere's node is not defined.
      const Vector3d aside = i == 0 ? Vector3d::Unit(shape.axis) : Vector3d(0.3, -0.5, 0.2 + 0.1 * i);
      const Vector3d t1 = n1.cross(aside).normalized();
      const double sigma = 0.15 * (i + 1), jacobi = 0.01;
      const auto end = internal::spheroid_geodesic<double>(shape, a, r1, t1, jacobi, sigma);
      const Vector3d inverse_square = a.cwiseProduct(a).cwiseInverse();
      const double invariant = n1.squaredNorm() * t1.dot(t1.cwiseProduct(inverse_square));
      const double abc = a.prod();
      Eigen::Vector4d lambda, y, v;
      lambda << invariant * inverse_square, 1.0 / (abc * abc);
      y << r1, jacobi;
      v << t1, 1.0;
      internal::integrate_geodesic<double>(lambda, inverse_square, end.length, 2000, y, v);
      EXPECT_NEAR((y.head<3>() - end.position).norm(), 0.0, 1e-10) << i;
      EXPECT_NEAR((v.head<3>() - end.direction).norm(), 0.0, 1e-8) << i;
      EXPECT_NEAR(y[3], end.jacobi, 1e-9) << i;
      EXPECT_NEAR(v[3], end.jacobi_slope, 1e-7) << i;
    }
  }
}

}  // namespace
}  // namespace veridyn::muscle
