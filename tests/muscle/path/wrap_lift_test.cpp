// Ends of a segment that lie inside their wrap object.
#include "veridyn/muscle/path/wrap_lift.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/muscle/path/wrap_checks.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/path/wrap_cylinder.hpp"
#include "veridyn/muscle/path/wrap_ellipsoid.hpp"
#include "veridyn/muscle/path/wrap_sphere.hpp"

namespace veridyn::muscle {
namespace {

using Eigen::Vector3d;

struct Slopes {
  double length = 0.0;
  Vector3d p = Vector3d::Zero(), q = Vector3d::Zero();
};

template <typename Object>
Slopes slopes(const Object& object, const Vector3d& p, const Vector3d& q) {
  const WrapResult<double> r = wrap(object, p, q);
  EXPECT_NE(r.status, WrapStatus::kFailed) << p.transpose() << " | " << q.transpose();
  if (r.wrapped()) return {r.length, r.gradient_p, r.gradient_q};
  const Vector3d along = (q - p).normalized();
  return {(q - p).norm(), -along, along};
}

/// Of random segments with an end inside: the slopes are those of the length, and they are bounded; where the end comes
/// to the surface they are those of a string that starts there.
template <typename Object>
void expect_a_continuous_slope(const Object& object, const Vector3d& inverse_square, double tolerance, double bound) {
  std::mt19937 random(23);
  const double size = 1.0 / std::sqrt(inverse_square.x());
  int inside = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d p = test::random_point(random, 1.2 * size), q = test::random_point(random, 3.0 * size);
    const double depth_p = 1.0 - std::sqrt(p.cwiseAbs2().dot(inverse_square));
    const double depth_q = 1.0 - std::sqrt(q.cwiseAbs2().dot(inverse_square));
    // Next to the surface the slope bends too sharply for differences, at the centre it has a corner.
    if (std::max(depth_p, depth_q) < 0.01 || std::min(std::abs(depth_p), std::abs(depth_q)) < 0.01) continue;
    if (std::max(depth_p, depth_q) > 0.95) continue;
    // At a quadrant's wall the side changes.
    if (std::min(std::abs(p.y()), std::abs(q.y())) < 1e-6) continue;
    ++inside;
    const Slopes here = slopes(object, p, q);
    const double h = 1e-5 * size;
    for (int k = 0; k < 6; ++k) {
      const Vector3d step = Vector3d::Unit(k % 3) * h;
      const auto length = [&](double times) {
        return k < 3 ? slopes(object, p + times * step, q).length : slopes(object, p, q + times * step).length;
      };
      const double slope = (8.0 * (length(1.0) - length(-1.0)) - (length(2.0) - length(-2.0))) / (12.0 * h);
      EXPECT_NEAR(slope, k < 3 ? here.p[k] : here.q[k - 3], tolerance) << p.transpose() << " | " << q.transpose();
    }
    EXPECT_LT(here.p.norm(), bound);
    EXPECT_LT(here.q.norm(), bound);
    if (depth_q > 0.0) continue;
    const Vector3d on = p / (1.0 - depth_p);
    const Slopes above = slopes(object, on * (1.0 + 1e-7), q), below = slopes(object, on * (1.0 - 1e-7), q);
    EXPECT_NEAR(above.length, below.length, 2.5e-7 * on.norm() * bound);
    // The surface's slope of a string, and that of one which starts 1e-7 beside it, differ by the root of 2e-7.
    EXPECT_NEAR((above.p - below.p).norm(), 0.0, 2e-3) << p.transpose() << " | " << q.transpose();
    EXPECT_NEAR((above.q - below.q).norm(), 0.0, 2e-3);
  }
  EXPECT_GT(inside, 300);
}

TEST(WrapLift, LengthsHaveAContinuousSlopeWhereAnEndDipsIn) {
  const double r2 = 1.0 / (0.02 * 0.02);
  expect_a_continuous_slope(WrapSphere{0.02, {}}, Vector3d::Constant(r2), 1e-8, 4.0);
  expect_a_continuous_slope(WrapCylinder{0.02, 10.0, {}}, Vector3d(r2, r2, 0.0), 1e-8, 4.0);
  // Round a wall, the long way.
  expect_a_continuous_slope(WrapCylinder{0.02, 10.0, {0, 1}}, Vector3d(r2, r2, 0.0), 1e-7, 10.0);
  const WrapEllipsoid spheroid{{0.025, 0.02, 0.02}, {}};
  expect_a_continuous_slope(spheroid, spheroid.radii.cwiseAbs2().cwiseInverse(), 1e-6, 4.0);
  const WrapEllipsoid ellipsoid{{0.03, 0.02, 0.025}, {}};
  expect_a_continuous_slope(ellipsoid, ellipsoid.radii.cwiseAbs2().cwiseInverse(), 5e-5, 4.0);
}

TEST(WrapLift, IsItsFormulaOnASphere) {
  // P at 0.8 R on x, Q at 3 R and an angle of 130 deg: the sphere shrinks to G R, the foot stands on it.
  const double R = 0.02, rho = 0.8, angle = 130.0 * kDegree, D = 3.0 * R;
  const Vector3d q(D * std::cos(angle), D * std::sin(angle), 0.0);
  const WrapResult<double> r = wrap(WrapSphere{R, {}}, Vector3d(rho * R, 0.0, 0.0), q);
  ASSERT_TRUE(r.wrapped());
  const double G = rho * (2.0 - rho), a = G * R;
  const double cosine = (q.x() - a) / (q - Vector3d(a, 0.0, 0.0)).norm(), eta = 1.0 - rho / G;
  const double string = std::sqrt(D * D - a * a) + a * (angle - std::acos(a / D));
  // What is left out of it is the gap of 1e-6 R at the surface.
  EXPECT_NEAR(r.length, string + (a - rho * R) * 0.5 * (cosine + std::hypot(cosine, eta)), 5e-8);
  EXPECT_NEAR(r.depth, 1.0 - rho, 1e-6);
}

TEST(WrapLift, ComesToTheStraightLineAtTheCentre) {
  const Vector3d q(-0.06, 0.01, 0.03);
  for (const double at : {1e-4, 1e-6, 0.0}) {
    const Vector3d p = Vector3d(0.3, 0.5, 0.1).normalized() * at * 0.02;
    const double allowed = 6.0 * at * 0.02 + 1e-9;
    EXPECT_NEAR(slopes(WrapSphere{0.02, {}}, p, q).length, (q - p).norm(), allowed);
    EXPECT_NEAR(slopes(WrapCylinder{0.02, 1.0, {}}, p, q).length, (q - p).norm(), allowed);
    EXPECT_NEAR(slopes(WrapEllipsoid{{0.03, 0.02, 0.025}, {}}, p, q).length, (q - p).norm(), 1.5 * allowed);
  }
}

TEST(WrapLift, DerivativesOfSlopesAreThoseOfTheLiftedPath) {
  using Jet = ceres::Jet<double, 6>;
  const WrapSphere sphere{0.02, {}};
  const Vector3d p(0.014, 0.002, -0.003), q(-0.05, 0.02, 0.01);
  Eigen::Matrix<Jet, 3, 1> pj, qj;
  for (int k = 0; k < 3; ++k) {
    pj[k] = Jet(p[k], k);
    qj[k] = Jet(q[k], 3 + k);
  }
  const WrapResult<Jet> jets = wrap(sphere, pj, qj);
  ASSERT_TRUE(jets.wrapped());
  const double h = 1e-7;
  for (int k = 0; k < 3; ++k) {
    const Vector3d step = Vector3d::Unit(k) * h;
    const Vector3d bend = (slopes(sphere, p + step, q).p - slopes(sphere, p - step, q).p) / (2.0 * h);
    EXPECT_NEAR(jets.length.v[k], jets.gradient_p[k].a, 1e-12);
    for (int m = 0; m < 3; ++m) EXPECT_NEAR(jets.gradient_p[m].v[k], bend[m], 1e-5 * (1.0 + std::abs(bend[m])));
  }
}

}  // namespace
}  // namespace veridyn::muscle
