#include "veridyn/muscle/path/wrap_end.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace veridyn::muscle::internal {
namespace {

TEST(WrapEnd, ADetourGoesFromAllOfItToNothing) {
  const double band = 0.01;
  EXPECT_EQ(detour_left(0.003, 0.0, band).length, 0.003);
  EXPECT_EQ(detour_left(0.003, 0.0, band).by_detour, 1.0);
  EXPECT_EQ(detour_left(0.003, 0.0, band).by_beyond, 0.0);
  // Half of it is left in the middle of its band.
  const double stretch = 1.5 * 0.003 / kSteepest;
  EXPECT_NEAR(detour_left(0.003, 0.5 * std::hypot(stretch, band), band).length, 0.0015, 1e-15);
  EXPECT_TRUE(detour_left(0.003, 1.0001 * std::hypot(stretch, band), band).none);
  EXPECT_FALSE(detour_left(0.003, 0.9999 * std::hypot(stretch, band), band).none);
  EXPECT_EQ(detour_left(0.003, 0.02, band).length, 0.0);
}

TEST(WrapEnd, LettingGoIsNeverSteeperThanItsBound) {
  const double band = 0.01, h = 1e-7;
  double steepest = 0.0;
  for (double detour = 1e-4; detour < 1.0; detour *= 1.3) {
    for (double beyond = 1e-5; beyond < 1.0; beyond *= 1.1) {
      const DetourLeft<double> left = detour_left(detour, beyond, band);
      const auto at = [&](double d, double b) { return detour_left(d, b, band).length; };
      EXPECT_NEAR(left.by_beyond, (at(detour, beyond + h) - at(detour, beyond - h)) / (2.0 * h), 1e-5);
      EXPECT_NEAR(left.by_detour, (at(detour + h, beyond) - at(detour - h, beyond)) / (2.0 * h), 1e-5);
      EXPECT_LE(left.by_beyond, 0.0);
      EXPECT_GE(left.by_detour, 0.0);
      EXPECT_LE(left.by_detour, 1.6);
      steepest = std::max(steepest, -left.by_beyond);
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
  WrapResult<double> result;
  set_beyond<double>(radius, half_length, radius, {-0.1, 0.0, 0.05}, {0.1, 0.0, 0.05}, path, result);
  EXPECT_NEAR(result.beyond, 0.05 - half_length - kEndStart * radius, 0.06 * radius);
  EXPECT_EQ(result.end_band, kEndBand * radius);
  EXPECT_NEAR(result.beyond_p.z() + result.beyond_q.z(), 1.0, 1e-12);
  result.clear();
  set_beyond<double>(radius, half_length, radius, {-0.1, 0.0, -0.05}, {0.1, 0.0, 0.09}, path, result);
  EXPECT_EQ(result.beyond, 0.0);
}

}  // namespace
}  // namespace veridyn::muscle::internal
