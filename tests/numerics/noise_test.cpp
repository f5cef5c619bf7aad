#include "veridyn/numerics/noise.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "veridyn/core/error.hpp"

namespace {
using namespace veridyn::numerics;

TEST(MeasurementNoise, IsFoundBelowManoeuvreAndEngine) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal(0.0, 0.05);
  std::vector<double> x;
  for (int k = 0; k < 30000; ++k) {
    const double t = 0.01 * k;
    x.push_back(9.81 + 3.0 * std::sin(2.0 * std::numbers::pi * 0.7 * t) + 0.1 * t +  // manoeuvre and drift
                0.5 * std::sin(2.0 * std::numbers::pi * (33.0 + 0.01 * t) * t) + normal(generator));
  }
  x[5000] = std::numeric_limits<double>::quiet_NaN();
  const NoiseEstimate noise = measurement_noise(x, 100.0, 15.0);
  EXPECT_TRUE(noise.determined);
  EXPECT_NEAR(noise.sd, 0.05, 0.004);
  EXPECT_GT(noise.line_share, 0.9);
}

TEST(MeasurementNoise, SaysWhenThereIsNone) {
  EXPECT_FALSE(measurement_noise(std::vector<double>(1000, 2.5), 100.0, 15.0).determined);
  EXPECT_FALSE(measurement_noise(std::vector<double>(20, 1.0), 100.0, 15.0).determined);
  EXPECT_THROW((void)measurement_noise(std::vector<double>(100, 0.0), 100.0, 50.0), veridyn::InputError);
}

}  // namespace
