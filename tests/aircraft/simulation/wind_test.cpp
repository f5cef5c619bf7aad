#include "veridyn/aircraft/simulation/wind.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::aircraft {
namespace {

TEST(Wind, GrowsWithHeightAndDriftsWithItsVariance) {
  WindSettings s;
  s.mean = {7, 0, 0};
  s.shear_exponent = 1.0 / 7.0;
  EXPECT_NEAR(Wind(s, numerics::RandomStream(1, "w")).at(80.0).x(), 7 * std::pow(8.0, 1.0 / 7.0), 1e-12);
  s.shear_exponent = 0.0;
  s.drift_sigma = 0.5;
  s.drift_time = 10.0;
  // 4000 independent ends: relative standard error of the variance sqrt(2/8000) = 1.6 % with both components.
  double sum = 0;
  for (std::uint64_t seed = 0; seed < 4000; ++seed) {
    Wind wind(s, numerics::RandomStream(seed, "w"));
    for (int i = 0; i < 20; ++i) wind.advance(5.0);
    const Eigen::Vector3d w = wind.at(50.0);
    sum += (w.x() - 7) * (w.x() - 7) + w.y() * w.y();
  }
  EXPECT_NEAR(sum / 8000, 0.25, 4 * 0.016 * 0.25);
}

}  // namespace
}  // namespace veridyn::aircraft
