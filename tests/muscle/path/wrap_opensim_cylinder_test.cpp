#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/muscle/path/wrap_checks.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/path/wrap_cylinder.hpp"
#include "veridyn/muscle/path/wrap_opensim.hpp"

namespace veridyn::muscle {
namespace {

using Eigen::Vector3d;

constexpr double kRadius = 0.02, kLength = 0.1;

OpenSimWrap around(const Vector3d& p, const Vector3d& q, WrapQuadrant quadrant = {}, bool only_wrap = true) {
  WrapObject cylinder;
  cylinder.shape = WrapShape::kCylinder;
  cylinder.dimensions = Vector3d(kRadius, kLength, 0.0);
  cylinder.quadrant = quadrant;
  return wrap_as_opensim(cylinder, EllipsoidMethod::kHybrid, only_wrap, p, q);
}

double whole_length(const OpenSimWrap& path, const Vector3d& p, const Vector3d& q) {
  return (path.r1 - p).norm() + path.surface_length + (q - path.r2).norm();
}

/// In a plane across the axis OpenSim's cylinder is the shortest path.
TEST(WrapCylinderAsOpenSim, IsTheTautPathWhereBothEndsLieInOnePlane) {
  const Vector3d p(0.05, 0.012, 0.0), q(-0.06, 0.005, 0.0);
  const OpenSimWrap path = around(p, q);
  EXPECT_EQ(path.action, OpenSimWrapAction::kMandatory);
  EXPECT_NEAR(whole_length(path, p, q), wrap(WrapCylinder{kRadius, 0.5 * kLength, {}}, p, q).length, 1e-12);
}

TEST(WrapCylinderAsOpenSim, StaysStraightPastTheObjectAndFromInsideIt) {
  EXPECT_EQ(around(Vector3d(0.05, 0.03, 0.0), Vector3d(-0.05, 0.03, 0.0)).action, OpenSimWrapAction::kNone);
  EXPECT_EQ(around(Vector3d(0.01, 0.0, 0.0), Vector3d(-0.05, 0.0, 0.0)).action, OpenSimWrapAction::kInside);
}

// It is an object of finite length: a path that touches the infinite cylinder beyond both ends of it goes straight.
TEST(WrapCylinderAsOpenSim, EndsWhereTheCylinderEnds) {
  const auto at_height = [](double z) { return around(Vector3d(0.05, 0.012, z), Vector3d(-0.06, 0.005, z)).wraps(); };
  EXPECT_TRUE(at_height(0.49 * kLength));
  EXPECT_FALSE(at_height(0.51 * kLength));
  EXPECT_FALSE(at_height(-0.51 * kLength));
}

// Both ends on the far side of the active quadrant: the path goes over the top, the long way round; of ends that lie
// close together by more than half a turn.
TEST(WrapCylinderAsOpenSim, AQuadrantSendsThePathTheLongWayRound) {
  for (const double x : {0.05, 0.01}) {
    const Vector3d p(x, -0.03, 0.0), q(-x, -0.03, 0.0);
    EXPECT_FALSE(around(p, q).wraps()) << "the straight line passes below";
    const OpenSimWrap over = around(p, q, {.axis = 1, .sign = 1});
    EXPECT_EQ(over.action, OpenSimWrapAction::kWrapped);
    EXPECT_NEAR(whole_length(over, p, q), wrap(WrapCylinder{kRadius, 0.5 * kLength, {1, 1}}, p, q).length, 1e-12);
    // Symmetric, by the closed form: from the tangent point of p over the top to that of q.
    const double half_angle = kPi - std::atan2(x, 0.03) - std::acos(kRadius / std::hypot(x, 0.03));
    EXPECT_NEAR(over.surface_length, 2.0 * kRadius * half_angle, 1e-12);
    EXPECT_EQ(half_angle > 0.5 * kPi, x == 0.01);
    EXPECT_FALSE(around(p, q, {.axis = 1, .sign = -1}).wraps()) << "that side is where the path is";
  }
}

// No path around a cylinder is shorter than the geodesic; OpenSim's approximation is near it, and nearer once its
// tangent points have been slid along the axis, which it does in a path of several wraps only.
TEST(WrapCylinderAsOpenSim, IsNoShorterThanTheGeodesicAndNearIt) {
  std::mt19937 random(11);
  int wraps = 0;
  double excess = 0.0, excess_of_slid = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p = test::random_point(random, 0.06), q = test::random_point(random, 0.06);
    const WrapResult<double> geodesic = wrap(WrapCylinder{kRadius, 10.0, {}}, p, q);
    if (!geodesic.wrapped() || geodesic.depth > 0.0) continue;
    const OpenSimWrap path = around(p, q), slid = around(p, q, {}, false);
    if (!path.wraps() || !slid.wraps()) continue;
    ++wraps;
    EXPECT_GE(whole_length(path, p, q), geodesic.length - 1e-12);
    EXPECT_GE(whole_length(slid, p, q), geodesic.length - 1e-12);
    excess += whole_length(path, p, q) / geodesic.length - 1.0;
    excess_of_slid += whole_length(slid, p, q) / geodesic.length - 1.0;
    // The points are on the surface, and the straight parts touch it.
    for (const auto& [r, end] : {std::pair{path.r1, p}, std::pair{path.r2, q}}) {
      EXPECT_NEAR(std::hypot(r.x(), r.y()), kRadius, 1e-12);
      EXPECT_NEAR((end - r).head<2>().dot(r.head<2>()), 0.0, 1e-12);
    }
  }
  ASSERT_GT(wraps, 200);
  EXPECT_LT(excess / wraps, 0.02);
  EXPECT_LT(excess_of_slid, excess);
}

}  // namespace
}  // namespace veridyn::muscle
