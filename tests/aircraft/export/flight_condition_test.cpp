#include "veridyn/aircraft/export/flight_condition.hpp"

#include <gtest/gtest.h>

namespace veridyn::aircraft {
namespace {

/// Ten seconds at 10 Hz: 15 m/s, and 20 m/s while the elevator is moved.
PreparedFlight flight() {
  PreparedFlight f;
  f.signals.grid = {.begin = 0.0, .step = 0.1, .count = 101};
  auto& airspeed = f.signals[FlightSignal::kAirspeed].value;
  for (int k = 0; k < 101; ++k) {
    airspeed.push_back(k >= 40 && k <= 60 ? 20.0 : 15.0);
    f.signals.air_density.push_back(1.1);
  }
  airspeed[50] = kNaN;
  f.segments.longitudinal.excited = {{4.0, 6.0}};
  return f;
}

TEST(FlightCondition, IsThatOfWhatWasExcited) {
  estimation::Estimate estimate;
  const std::vector<PreparedFlight> flights = {flight()};
  add_flight_condition(flights, estimate);
  const auto condition = condition_of(estimate);
  ASSERT_TRUE(condition);
  EXPECT_EQ(condition->airspeed, 20.0);
  EXPECT_EQ(condition->density, 1.1);
}

TEST(FlightCondition, IsNoneWhereNothingWasExcited) {
  estimation::Estimate estimate;
  PreparedFlight still = flight();
  still.segments = {};
  const std::vector<PreparedFlight> flights = {still};
  add_flight_condition(flights, estimate);
  EXPECT_FALSE(condition_of(estimate));
  estimate.fit = {{"flight.airspeed", kNaN}, {"flight.air_density", 1.2}};
  EXPECT_FALSE(condition_of(estimate));
}

}  // namespace
}  // namespace veridyn::aircraft
