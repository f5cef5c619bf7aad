#include "veridyn/aircraft/identification/signals/excited_segments.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/constants.hpp"

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
  signals.vel_down = s.vel_down;
  return find_segments(signals, options);
}

void leave_out_slow_flight(FlightSignals& s, const Segments& segments, double min_airspeed_mps) {
  std::size_t slow = 0;
  std::vector<double>& airspeed = s[FlightSignal::kAirspeed].value;
  for (std::size_t k = 0; k < airspeed.size(); ++k) {
    if (!(airspeed[k] <= min_airspeed_mps)) continue;
    airspeed[k] = kNaN;
    const auto here = [&](const TimeSpan& span) { return span.contains(s.grid.at(k)); };
    const auto among = [&](const std::vector<TimeSpan>& spans) { return std::ranges::any_of(spans, here); };
    slow += among(segments.airborne) || among(segments.longitudinal.excited) || among(segments.lateral.excited) ? 1 : 0;
  }
  if (slow > 0)
    s.notes.push_back(fmt::format(
        "the airspeed is below {:.1f} m/s (segments.min_airspeed) for {:.1f} s within the flight, as of a stall or a "
        "blocked pitot tube: not used",
        min_airspeed_mps, static_cast<double>(slow) * s.grid.step));
}

}  // namespace veridyn::aircraft
