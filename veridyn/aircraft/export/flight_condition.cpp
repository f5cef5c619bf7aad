#include "veridyn/aircraft/export/flight_condition.hpp"

#include <cmath>
#include <vector>

#include "veridyn/numerics/statistics.hpp"

namespace veridyn::aircraft {

void add_flight_condition(std::span<const PreparedFlight> flights, estimation::Estimate& estimate) {
  std::vector<double> airspeed, density;
  const auto add = [](const std::vector<double>& from, std::size_t k, std::vector<double>& to) {
    if (k < from.size() && std::isfinite(from[k])) to.push_back(from[k]);
  };
  for (const PreparedFlight& flight : flights) {
    if (!flight.usable()) continue;
    const FlightSignals& signals = flight.signals;
    for (const AxisSegments* axis : {&flight.segments.longitudinal, &flight.segments.lateral}) {
      for (const TimeSpan& span : axis->excited) {
        const auto [first, last] = signals.indices(span);
        for (std::size_t k = first; k < last; ++k) {
          add(signals[FlightSignal::kAirspeed].value, k, airspeed);
          add(signals.air_density, k, density);
        }
      }
    }
  }
  if (!airspeed.empty()) estimate.fit["flight.airspeed"] = numerics::median(airspeed);
  if (!density.empty()) estimate.fit["flight.air_density"] = numerics::median(density);
}

std::optional<ExportCondition> condition_of(const estimation::Estimate& estimate) {
  const auto airspeed = estimate.fit.find("flight.airspeed"), density = estimate.fit.find("flight.air_density");
  if (airspeed == estimate.fit.end() || density == estimate.fit.end()) return std::nullopt;
  if (!(airspeed->second > 0.0) || !(density->second > 0.0)) return std::nullopt;
  return ExportCondition{airspeed->second, density->second, "of the flight"};
}

}  // namespace veridyn::aircraft
