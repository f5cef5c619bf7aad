#include "veridyn/aircraft/identification/rows/typical_flight.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "veridyn/numerics/statistics.hpp"

namespace veridyn::aircraft {
namespace {

double median_of(std::span<const PreparedFlight> flights,
                 const std::function<std::span<const double>(const FlightSignals&)>& signal) {
  std::vector<double> values;
  for (const PreparedFlight& flight : flights) {
    if (!flight.usable()) continue;
    const std::span<const double> all = signal(flight.signals);
    for (const AxisSegments* axis : {&flight.segments.longitudinal, &flight.segments.lateral}) {
      for (const TimeSpan& span : axis->excited) {
        const auto [first, last] = flight.signals.indices(span);
        for (std::size_t k = first; k < std::min(last, all.size()); ++k) values.push_back(all[k]);
      }
    }
  }
  return numerics::median(values);
}

}  // namespace

std::optional<Trim> typical_flight(std::span<const PreparedFlight> flights, std::optional<double> airspeed) {
  const auto typical = [&](FlightSignal which) {
    return median_of(flights, [which](const FlightSignals& s) { return std::span<const double>(s[which].value); });
  };
  const auto or_zero = [](double value) { return std::isfinite(value) ? value : 0.0; };
  Trim flown;
  flown.condition.airspeed = airspeed.value_or(typical(FlightSignal::kAirspeed));
  flown.condition.density =
      median_of(flights, [](const FlightSignals& s) { return std::span<const double>(s.air_density); });
  flown.alpha = or_zero(typical(FlightSignal::kAlpha));
  flown.controls.de = or_zero(typical(FlightSignal::kElevator));
  flown.controls.da = or_zero(typical(FlightSignal::kAileron));
  flown.controls.dr = or_zero(typical(FlightSignal::kRudder));
  if (!(flown.condition.airspeed > 0.0) || !(flown.condition.density > 0.0)) return {};
  return flown;
}

}  // namespace veridyn::aircraft
