#pragma once

#include <span>

#include "veridyn/aircraft/identification/evidence/checked_flight.hpp"
#include "veridyn/aircraft/identification/signals/segments.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct.hpp"

/// What is said of a flight whose reconstruction ended at a contradiction.
namespace veridyn::aircraft {

/// Where a recording flies by its own airspeed (or else dynamic pressure at sea level, or ground speed) above
/// `min_airspeed_mps`, with interruptions of up to 2 s; no excited stretches.
[[nodiscard]] Segments recorded_flight(const Recording& recording, double min_airspeed_mps);

/// The row of the contradiction. `causes` are the other rows of the recording: where one of them has found the sensor
/// that is wrong, the row is about that, else about the sensor that was refused. `limit_s`: of refusal.
[[nodiscard]] estimation::Evidence contradiction_row(const Contradiction& contradiction, double limit_s,
                                                     std::span<const estimation::Evidence> causes);

}  // namespace veridyn::aircraft
