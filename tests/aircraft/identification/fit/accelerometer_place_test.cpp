#include "veridyn/aircraft/identification/fit/accelerometer_place.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/aircraft/campaign/campaign.hpp"

namespace veridyn::aircraft {
namespace {

SensorError height_of(const testing::Identified& flight) {
  const std::vector<SensorError>& errors = flight.analysis.flights.front().budget.errors;
  return *std::ranges::find(errors, SensorErrorKind::kPlaceZ, &SensorError::kind);
}

// Read 8 cm below where it is said to be, CY_da would be -0.8 and CY_p in proportion.
TEST(AccelerometerPlace, ItsHeightIsFoundByTheAilerons) {
  FlightStudy study = aircraft::testing::campaign_flight("unatrap", 4, 120.0, "low_light");
  const SensorError right = height_of(aircraft::testing::identified(study));
  EXPECT_NEAR(right.mean, 0.0, 2.0 * right.sigma);
  EXPECT_LT(right.sigma, 0.015);
  study.subject.imu_position[2] = -0.08;
  const SensorError wrong = height_of(aircraft::testing::identified(study));
  EXPECT_NEAR(wrong.mean, 0.08, 3.0 * wrong.sigma);
  study.known_sensors.errors = {{BudgetSensor::kAccelerometer, SensorErrorKind::kPlaceZ, 0.0, 0.001}};
  EXPECT_NEAR(height_of(aircraft::testing::identified(study)).sigma, 0.001, 1e-4);
}

}  // namespace
}  // namespace veridyn::aircraft
