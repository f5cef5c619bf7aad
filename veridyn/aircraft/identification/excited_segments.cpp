#include "veridyn/aircraft/identification/excited_segments.hpp"

namespace veridyn::aircraft {

Segments excited_segments(const FlightSignals& s, const SegmentOptions& options) {
  SegmentSignals signals;
  signals.begin = s.grid.begin;
  signals.step = s.grid.step;
  signals.airspeed = s[FlightSignal::kAirspeed].value;
  signals.p = s[FlightSignal::kP].value;
  signals.q = s[FlightSignal::kQ].value;
  signals.r = s[FlightSignal::kR].value;
  signals.elevator = s[FlightSignal::kElevator].value;
  signals.aileron = s[FlightSignal::kAileron].value;
  signals.rudder = s[FlightSignal::kRudder].value;
  return find_segments(signals, options);
}

}  // namespace veridyn::aircraft
