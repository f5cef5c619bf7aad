#pragma once

#include <optional>
#include <span>

#include "veridyn/aircraft/identification/rows/prepared_flight.hpp"
#include "veridyn/aircraft/model/trim.hpp"

namespace veridyn::aircraft {

/// Straight flight at the medians of airspeed, density, alpha and deflections of what was excited, or at an airspeed
/// [m/s] that is given; nothing where nothing was, or no flight's motion is known.
[[nodiscard]] std::optional<Trim> typical_flight(std::span<const PreparedFlight> flights,
                                                 std::optional<double> airspeed = {});

}  // namespace veridyn::aircraft
