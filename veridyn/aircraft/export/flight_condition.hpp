#pragma once

#include <optional>
#include <span>
#include <string>

#include "veridyn/aircraft/identification/rows/prepared_flight.hpp"
#include "veridyn/estimation/result/estimate.hpp"

namespace veridyn::aircraft {

/// Steady level flight that an exported aircraft is flown in.
struct ExportCondition {
  double airspeed = 20.0;  ///< [m/s]
  double density = 1.225;  ///< [kg/m^3]
  std::string source;      ///< in words: "of the flight"
};

/// Writes into `fit` of an estimate the condition that it is of: `flight.airspeed` [m/s] and `flight.air_density`
/// [kg/m^3], medians over what was excited.
void add_flight_condition(std::span<const PreparedFlight> flights, estimation::Estimate& estimate);

/// The same, read again; none where the estimate does not say.
[[nodiscard]] std::optional<ExportCondition> condition_of(const estimation::Estimate& estimate);

}  // namespace veridyn::aircraft
