#pragma once

#include "veridyn/aircraft/identification/signals/flight_signals.hpp"
#include "veridyn/aircraft/identification/signals/segments.hpp"

namespace veridyn::aircraft {

/// The parts of a flight in the air and those in which it is excited, from its prepared signals.
[[nodiscard]] Segments excited_segments(const FlightSignals& signals, const SegmentOptions& options);

/// Takes the airspeed away (NaN) where it is below the least one of flight, so that no row is formed there: short dips
/// (a tube that is blocked, a stall) are within the parts in the air, and coefficients are forces over the airspeed's
/// square. Adds a note of how long that is within `segments`.
void leave_out_slow_flight(FlightSignals& signals, const Segments& segments, double min_airspeed_mps);

}  // namespace veridyn::aircraft
