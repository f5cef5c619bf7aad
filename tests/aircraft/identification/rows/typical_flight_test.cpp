#include "veridyn/aircraft/identification/rows/typical_flight.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

/// Ten seconds at 10 Hz of which four to six are excited, where the elevator stands at 0.1 rad.
PreparedFlight excited_flight() {
  PreparedFlight flight;
  flight.signals.grid = {.begin = 0.0, .step = 0.1, .count = 101};
  for (int k = 0; k < 101; ++k) {
    const bool excited = k >= 40 && k <= 60;
    flight.signals[FlightSignal::kAirspeed].value.push_back(excited ? 20.0 : 15.0);
    flight.signals[FlightSignal::kElevator].value.push_back(excited ? 0.1 : 0.0);
    flight.signals.air_density.push_back(1.1);
  }
  flight.segments.lateral.excited = {{4.0, 6.0}};
  return flight;
}

TEST(TypicalFlight, IsTheMedianOfWhatWasExcited) {
  const std::vector<PreparedFlight> flights = {excited_flight()};
  const Trim flown = typical_flight(flights).value();
  EXPECT_EQ(flown.condition.airspeed, 20.0);
  EXPECT_EQ(flown.condition.density, 1.1);
  EXPECT_EQ(flown.controls.de, 0.1);
  EXPECT_EQ(flown.alpha, 0.0) << "without a vane";
  EXPECT_EQ(typical_flight(flights, 25.0).value().condition.airspeed, 25.0);
}

TEST(TypicalFlight, IsNoneWhereTheMotionIsNotKnown) {
  PreparedFlight flight = excited_flight();
  flight.reconstruction.contradiction = Contradiction{};
  EXPECT_FALSE(typical_flight(std::vector<PreparedFlight>{flight}));
}

}  // namespace
}  // namespace veridyn::aircraft
