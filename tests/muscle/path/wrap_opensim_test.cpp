#include "veridyn/muscle/path/wrap_opensim.hpp"

#include <gtest/gtest.h>

#include "veridyn/muscle/path/wrap_sphere.hpp"

namespace veridyn::muscle {
namespace {

using Eigen::Vector3d;

WrapObject sphere() {
  WrapObject wrap;
  wrap.shape = WrapShape::kSphere;
  wrap.dimensions = Vector3d(0.02, 0.1, 0.0);
  return wrap;
}

OpenSimWrap wrapped(const Vector3d& p, const Vector3d& q) {
  return wrap_as_opensim(sphere(), EllipsoidMethod::kHybrid, true, p, q);
}

/// In a plane through its centre OpenSim's sphere is the shortest path.
TEST(WrapAsOpenSim, IsTheTautPathWhereBothEndsLieInOnePlane) {
  const Vector3d p(0.05, 0.012, 0.0), q(-0.06, 0.005, 0.0);
  const OpenSimWrap path = wrapped(p, q);
  EXPECT_TRUE(path.wraps());
  EXPECT_NEAR((path.r1 - p).norm() + path.surface_length + (q - path.r2).norm(),
              wrap(WrapSphere{0.02, {}}, p, q).length, 1e-12);
}

TEST(WrapAsOpenSim, StaysStraightPastTheObjectAndFromInsideIt) {
  EXPECT_EQ(wrapped(Vector3d(0.05, 0.03, 0.0), Vector3d(-0.05, 0.03, 0.0)).action, OpenSimWrapAction::kNone);
  EXPECT_EQ(wrapped(Vector3d(0.01, 0.0, 0.0), Vector3d(-0.05, 0.0, 0.0)).action, OpenSimWrapAction::kInside);
}

}  // namespace
}  // namespace veridyn::muscle
