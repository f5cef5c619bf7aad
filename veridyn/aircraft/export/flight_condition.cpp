#include "veridyn/aircraft/export/flight_condition.hpp"

#include "veridyn/aircraft/identification/rows/typical_flight.hpp"

namespace veridyn::aircraft {

void add_flight_condition(std::span<const PreparedFlight> flights, estimation::Estimate& estimate) {
  const std::optional<Trim> flown = typical_flight(flights);
  if (!flown) return;
  estimate.fit["flight.airspeed"] = flown->condition.airspeed;
  estimate.fit["flight.air_density"] = flown->condition.density;
}

std::optional<ExportCondition> condition_of(const estimation::Estimate& estimate) {
  const auto airspeed = estimate.fit.find("flight.airspeed"), density = estimate.fit.find("flight.air_density");
  if (airspeed == estimate.fit.end() || density == estimate.fit.end()) return std::nullopt;
  if (!(airspeed->second > 0.0) || !(density->second > 0.0)) return std::nullopt;
  return ExportCondition{airspeed->second, density->second, "of the flight"};
}

}  // namespace veridyn::aircraft
