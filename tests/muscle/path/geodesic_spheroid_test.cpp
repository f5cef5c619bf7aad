#include "veridyn/muscle/path/geodesic_spheroid.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "veridyn/muscle/path/wrap_ellipsoid.hpp"

namespace veridyn::muscle {
namespace {

using Eigen::Vector3d;

TEST(GeodesicSpheroid, IsTheIntegratedGeodesic) {
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
