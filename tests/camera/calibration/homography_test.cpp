#include "veridyn/camera/calibration/homography.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::camera {
namespace {

/// The unit square seen as a trapezoid: H of Heckbert (1989), Fundamentals of Texture Mapping, section 2.2.3, by hand
/// for corners (0, 0), (4, 0), (3, 2), (1, 2): the sides meet at (2, 4), so that w = 1 + y.
TEST(Homography, MapsTheUnitSquareToATrapezoid) {
  CalibrationPoints points{.source = "square",
                           .points = {{{0.0, 0.0}, {0.0, 0.0}, 0},
                                      {{1.0, 0.0}, {4.0, 0.0}, 0},
                                      {{1.0, 1.0}, {3.0, 2.0}, 0},
                                      {{0.0, 1.0}, {1.0, 2.0}, 0}}};
  Eigen::Matrix3d H = direct_linear_homography(points);
  H /= H(2, 2);
  Eigen::Matrix3d expected;
  expected << 4.0, 2.0, 0.0, 0.0, 4.0, 0.0, 0.0, 1.0, 1.0;
  EXPECT_LT((H - expected).norm(), 1e-12) << H;
}

TEST(Homography, IsFoundFarFromTheOriginToo) {
  Eigen::Matrix3d truth;
  truth << 430.0, 3.0, 900.0, -2.0, -431.0, 500.0, 1e-3, 2e-3, 1.0;
  CalibrationPoints points{.source = "far", .points = {}};
  for (double x = 1000.0; x < 1004.0; x += 0.5) {
    for (double y = 500.0; y < 503.0; y += 0.5) {
      const Eigen::Vector3d q = truth * Eigen::Vector3d(x - 1000.0, y - 500.0, 1.0);
      points.points.push_back({{x, y}, q.head<2>() / q(2), 0});
    }
  }
  const Eigen::Matrix3d H = direct_linear_homography(points);
  for (const CalibrationPoint& p : points.points) {
    const Eigen::Vector3d q = H * p.track.homogeneous();
    EXPECT_LT((q.head<2>() / q(2) - p.image).norm(), 1e-7);
  }
}

}  // namespace
}  // namespace veridyn::camera
