#include "veridyn/muscle/path/wrap_opensim.hpp"

#include <gtest/gtest.h>

#include "veridyn/muscle/path/wrap_cylinder.hpp"
#include "veridyn/muscle/path/wrap_sphere.hpp"

namespace veridyn::muscle {
namespace {

using Eigen::Vector3d;

WrapObject object(WrapShape shape) {
  WrapObject wrap;
  wrap.shape = shape;
  wrap.dimensions = Vector3d(0.02, 0.1, 0.0);
  return wrap;
}

double length_of(const OpenSimWrap& wrap, const Vector3d& p, const Vector3d& q) {
  return (wrap.r1 - p).norm() + wrap.surface_length + (q - wrap.r2).norm();
}

/// In a plane across the axis OpenSim's cylinder and sphere are the shortest paths.
TEST(WrapAsOpenSim, IsTheTautPathWhereBothEndsLieInOnePlane) {
  const Vector3d p(0.05, 0.012, 0.0), q(-0.06, 0.005, 0.0);
  const OpenSimWrap cylinder = wrap_as_opensim(object(WrapShape::kCylinder), EllipsoidMethod::kHybrid, true, p, q);
  EXPECT_EQ(cylinder.action, OpenSimWrapAction::kMandatory);
  EXPECT_NEAR(length_of(cylinder, p, q), wrap(WrapCylinder{0.02, 0.05, {}}, p, q).length, 1e-12);
  const OpenSimWrap sphere = wrap_as_opensim(object(WrapShape::kSphere), EllipsoidMethod::kHybrid, true, p, q);
  EXPECT_TRUE(sphere.wraps());
  EXPECT_NEAR(length_of(sphere, p, q), wrap(WrapSphere{0.02, {}}, p, q).length, 1e-12);
}

TEST(WrapAsOpenSim, StaysStraightPastTheObjectAndFromInsideIt) {
  for (const WrapShape shape : {WrapShape::kCylinder, WrapShape::kSphere}) {
    const auto action = [&](const Vector3d& p, const Vector3d& q) {
      return wrap_as_opensim(object(shape), EllipsoidMethod::kHybrid, true, p, q).action;
    };
    EXPECT_EQ(action(Vector3d(0.05, 0.03, 0.0), Vector3d(-0.05, 0.03, 0.0)), OpenSimWrapAction::kNone);
    EXPECT_EQ(action(Vector3d(0.01, 0.0, 0.0), Vector3d(-0.05, 0.0, 0.0)), OpenSimWrapAction::kInside);
  }
}

}  // namespace
}  // namespace veridyn::muscle
