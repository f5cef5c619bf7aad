#pragma once

#include "veridyn/aircraft/identification/flight_signals.hpp"
#include "veridyn/aircraft/identification/segments.hpp"

namespace veridyn::aircraft {

/// The parts of a flight in the air and those in which it is excited, from its prepared signals.
[[nodiscard]] Segments excited_segments(const FlightSignals& signals, const SegmentOptions& options);

}  // namespace veridyn::aircraft
