#include "veridyn/muscle/path/wrap_end.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace veridyn::muscle::internal {
namespace {

TEST(WrapEnd, AWrapGoesFromAllOfItToNothing) {
  const double band = 0.01;
  EXPECT_EQ(letting_go(0.003, 0.0, band).part, 1.0);
  EXPECT_EQ(letting_go(0.003, 0.0, band).by_detour, 0.0);
  EXPECT_EQ(letting_go(0.003, 0.0, band).by_beyond, 0.0);
  // Half of it is left in the middle of its band.
  const double whole = std::hypot(1.5 * 0.003 / kSteepest, band);
  EXPECT_NEAR(letting_go(0.003, 0.5 * whole, band).part, 0.5, 1e-15);
  EXPECT_GT(letting_go(0.003, 0.9999 * whole, band).part, 0.0);
  EXPECT_EQ(letting_go(0.003, 1.0001 * whole, band).part, 0.0);
}

TEST(WrapEnd, LettingGoIsNeverSteeperThanItsBound) {
  const double band = 0.01, h = 1e-7;
  double steepest = 0.0;
  for (double detour = 1e-4; detour < 1.0; detour *= 1.3) {
    for (double beyond = 1e-5; beyond < 1.0; beyond *= 1.1) {
      const LettingGo<double> left = letting_go(detour, beyond, band);
      const auto at = [&](double d, double b) { return letting_go(d, b, band).part; };
      EXPECT_NEAR(left.by_beyond, (at(detour, beyond + h) - at(detour, beyond - h)) / (2.0 * h), 1e-3);
      EXPECT_NEAR(left.by_detour, (at(detour + h, beyond) - at(detour - h, beyond)) / (2.0 * h), 1e-3);
      // Of what is left of the detour, part times detour.
      const double slope = left.part + detour * left.by_detour;
      EXPECT_GE(slope, 0.0);
      EXPECT_LE(slope, 1.6);
      EXPECT_LE(left.by_beyond, 0.0);
      steepest = std::max(steepest, -detour * left.by_beyond);
    }
  }
  EXPECT_LE(steepest, kSteepest);
  EXPECT_GT(steepest, 0.95 * kSteepest);
}

TEST(WrapEnd, HowFarAPathIsBeyondIsTheHeightOfItsNearerTangentPoint) {
  // Ends far from the surface at one height, and with one tangent point that is still on the cylinder.
  const double radius = 0.02, half_length = 0.03;
  const double d = std::sqrt(0.1 * 0.1 - radius * radius);
  const Eigen::Vector3d e = Eigen::Vector3d::UnitX();
  const PlanarPath<double> path{2.0 * d, e, e, 0.0};
  const Beyond<double> beyond =
      how_far_beyond<double>(radius, half_length, radius, {-0.1, 0.0, 0.05}, {0.1, 0.0, 0.05}, path);
  EXPECT_NEAR(beyond.by, 0.05 - half_length - kEndStart * radius, 0.06 * radius);
  EXPECT_NEAR(beyond.by_p.z() + beyond.by_q.z(), 1.0, 1e-12);
  EXPECT_FALSE(how_far_beyond<double>(radius, half_length, radius, {-0.1, 0.0, -0.05}, {0.1, 0.0, 0.09}, path).any());
}

}  // namespace
}  // namespace veridyn::muscle::internal
