#include "veridyn/muscle/dynamics/spatial.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>

namespace veridyn::muscle {
namespace {

using Eigen::Vector3d;

const SpatialVector<double> kMotion{Vector3d(0.3, -1.2, 0.7), Vector3d(-0.4, 0.9, 2.0)};

TEST(RigidInertia, MomentumIsThatOfItsPoints) {
  const std::array<Vector3d, 3> points{Vector3d(1.0, 0.2, -0.3), Vector3d(0.7, -0.5, 0.4), Vector3d(-0.2, 0.6, 0.9)};
  RigidInertia<double> sum;
  SpatialVector<double> momentum;
  double twice_energy = 0.0;
  for (const Vector3d& x : points) {
    sum += RigidInertia<double>::of(1.7, x, {});
    const Vector3d p = 1.7 * kMotion.at(x);
    momentum += {x.cross(p), p};
    twice_energy += p.dot(kMotion.at(x));
  }
  const SpatialVector<double> found = sum * kMotion;
  EXPECT_NEAR((found.angular - momentum.angular).norm(), 0.0, 1e-14);
  EXPECT_NEAR((found.linear - momentum.linear).norm(), 0.0, 1e-14);
  EXPECT_NEAR(found.dot(kMotion), twice_energy, 1e-13);
}

/// A displacement x -> R x + d takes the motion (a, l) to (R a, R l + d x R a).
TEST(CrossMotion, IsTheRateOfAMotionCarriedAlong) {
  const SpatialVector<double> axis{Vector3d(0.2, 0.5, -0.8), Vector3d(1.0, -0.3, 0.4)};
  const auto carried = [&](double t) {
    const double angle = kMotion.angular.norm() * t;
    const Eigen::Matrix3d R = Eigen::AngleAxisd(angle, kMotion.angular.normalized()).toRotationMatrix();
    const Vector3d angular = R * axis.angular;
    return SpatialVector<double>{angular, R * axis.linear + (kMotion.linear * t).cross(angular)};
  };
  const double h = 1e-5;
  const SpatialVector<double> up = carried(h), down = carried(-h), rate = cross_motion(kMotion, axis);
  EXPECT_NEAR(((up.angular - down.angular) / (2.0 * h) - rate.angular).norm(), 0.0, 1e-9);
  EXPECT_NEAR(((up.linear - down.linear) / (2.0 * h) - rate.linear).norm(), 0.0, 1e-9);
  // Power is the same whichever of motion and momentum is carried.
  const SpatialVector<double> momentum{Vector3d(0.1, 0.2, 0.3), Vector3d(-1.0, 0.5, 0.25)};
  EXPECT_NEAR(cross_motion(kMotion, axis).dot(momentum), -axis.dot(cross_force(kMotion, momentum)), 1e-14);
}

}  // namespace
}  // namespace veridyn::muscle
