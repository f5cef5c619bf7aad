#include "veridyn/aircraft/identification/rows/flight_set.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Outcome;
using estimation::Purpose;

FlightEvidence left_out(const PreparedFlight& flight) {
  return {{.name = "flight left out",
           .about = flight.name,
           .outcome = Outcome::kCare,
           .value = kNaN,
           .limit = kNaN,
           .text = fmt::format("{} is left out: {}", flight.name, flight.reconstruction.contradiction->statement),
           .bears_on = Purpose::kData,
           .advice = fmt::format("analyse {} by itself, and mend it or take it out of the study", flight.name)}};
}

FlightEvidence nothing_excited(const PreparedFlight& flight) {
  return {{.name = "nothing excited",
           .about = flight.name,
           .outcome = Outcome::kCare,
           .value = 0.0,
           .limit = 0.0,
           .scale = "s excited",
           .text = fmt::format("{} tells nothing of the coefficients: {}; {}", flight.name,
                               flight.segments.longitudinal.text, flight.segments.lateral.text),
           .bears_on = Purpose::kData,
           .advice = fmt::format("take {} out of the study, or lower segments.min_input", flight.name)}};
}

std::string use_of(const PreparedFlight& flight, bool tried) {
  const auto any = [&](std::vector<TimeSpan> recording::Segments::*spans) {
    return !(flight.segments.longitudinal.*spans).empty() || !(flight.segments.lateral.*spans).empty();
  };
  if (!flight.usable()) return "left out";
  if (!any(&recording::Segments::excited)) return "nothing excited";
  if (tried) return "validation";
  const bool identification = any(&recording::Segments::identification), holdout = any(&recording::Segments::holdout);
  if (identification && holdout) return "identification and hold-out";
  return identification ? "identification" : "hold-out";
}

}  // namespace

std::string of_flight(std::string_view name, std::string_view text) {
  return name.empty() ? std::string(text) : fmt::format("{}: {}", name, text);
}

Segments all_held_out(Segments segments) {
  for (AxisSegments* axis : {&segments.longitudinal, &segments.lateral}) {
    axis->holdout = axis->excited;
    axis->identification.clear();
  }
  return segments;
}

std::vector<estimation::RecordingUse> recording_uses(std::span<const PreparedFlight> flights, bool tried) {
  std::vector<estimation::RecordingUse> uses;
  if (flights.size() < 2) return uses;
  for (const PreparedFlight& flight : flights) uses.push_back({.name = flight.name, .use = use_of(flight, tried)});
  return uses;
}

std::vector<PreparedFlight> side_by_side(std::vector<PreparedFlight> flights) {
  const bool any_usable = std::ranges::any_of(flights, &PreparedFlight::usable);
  double end = flights.front().aligned.recording.span().begin;
  for (PreparedFlight& flight : flights) {
    const TimeSpan span = flight.aligned.recording.span();
    flight.shift_s = end - span.begin;
    end += span.duration() + kBetweenFlights_s;
    for (FlightEvidence& e : flight.recording_evidence) {
      e.row.about = e.row.about.empty() ? flight.name : of_flight(flight.name, e.row.about);
      e.row.text = of_flight(flight.name, e.row.text);
    }
    if (!flight.usable() && any_usable)
      flight.recording_evidence = {left_out(flight)};
    else if (flight.usable() && flight.segments.longitudinal.excited.empty() && flight.segments.lateral.excited.empty())
      flight.recording_evidence.push_back(nothing_excited(flight));
  }
  return flights;
}

}  // namespace veridyn::aircraft
