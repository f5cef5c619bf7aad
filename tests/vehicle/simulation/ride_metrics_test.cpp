#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "tests/vehicle/simulation/metric_value.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/simulation/manoeuvre_metrics.hpp"

namespace veridyn::vehicle {
namespace {

using testing::value;

// Frequency weighting W_k of ISO 2631-1:1997, table 3, at nominal third-octave frequencies, to the printed digits.
TEST(ManoeuvreMetrics, WeightsVibrationAsTheStandardPrints) {
  const std::pair<double, double> table[] = {{0.5, 0.418}, {1.0, 0.482}, {2.0, 0.531},  {2.5, 0.631},  {4.0, 0.967},
                                             {6.3, 1.054}, {8.0, 1.036}, {10.0, 0.988}, {20.0, 0.636}, {40.0, 0.314}};
  for (const auto& [frequency, weight] : table) EXPECT_NEAR(iso2631_weight(frequency), weight, 6e-4) << frequency;
  EXPECT_EQ(iso2631_weight(0.0), 0.0);
}

// A heave of amplitude A at 4 Hz: rms acceleration A w^2/sqrt(2), weighted by W_k(4 Hz).
TEST(ManoeuvreMetrics, RideIsTheRmsOfTheWeightedAcceleration) {
  VehicleTrajectory t;
  const double w = 2.0 * kPi * 4.0;
  for (int k = 0; k < 10000; ++k) {
    t.time.push_back(k * 1e-3);
    t.heave_rate.push_back(0.01 * w * std::cos(w * t.time.back()));
    for (auto& load : t.Fz) load.push_back(3000.0 + 300.0 * std::sin(w * t.time.back()));
  }
  const std::vector<Metric> list = ride_metrics(t);
  const double expected = 0.01 * w * w / std::numbers::sqrt2;
  EXPECT_NEAR(value(list, "vertical_acceleration_rms"), expected, 2e-4 * expected);  // central differences, (w h)^2/6
  EXPECT_NEAR(value(list, "weighted_vertical_acceleration_rms"), expected * iso2631_weight(4.0), 3e-4 * expected);
  EXPECT_NEAR(value(list, "wheel_load_variation"), 0.1 / std::numbers::sqrt2, 1e-9);
  EXPECT_TRUE(ride_metrics(VehicleTrajectory{}).empty());
}

}  // namespace
}  // namespace veridyn::vehicle
