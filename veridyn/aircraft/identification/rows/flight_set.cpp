#include "veridyn/aircraft/identification/rows/flight_set.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Check;
using estimation::Evidence;
using estimation::Outcome;
using estimation::row_of;

Evidence left_out(const PreparedFlight& flight) {
  return row_of(Check::kFlightLeftOut, flight.name, Outcome::kCare)
      .with("statement", flight.reconstruction.contradiction->statement);
}

Evidence nothing_excited(const PreparedFlight& flight) {
  Evidence row = row_of(Check::kNothingExcited, flight.name, Outcome::kCare);
  row.value = row.limit = 0.0;
  row.cause = estimation::Cause::kExcitation;
  return std::move(row)
      .with("longitudinal", flight.segments.longitudinal.text)
      .with("lateral", flight.segments.lateral.text);
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
  const auto excited = [](const PreparedFlight& flight) {
    return flight.usable() &&
           !(flight.segments.longitudinal.excited.empty() && flight.segments.lateral.excited.empty());
  };
  const bool any_usable = std::ranges::any_of(flights, &PreparedFlight::usable);
  const bool any_excited = std::ranges::any_of(flights, excited);
  double end = flights.front().aligned.recording.span().begin;
  for (PreparedFlight& flight : flights) {
    const TimeSpan span = flight.aligned.recording.span();
    flight.shift_s = end - span.begin;
    end += span.duration() + kBetweenFlights_s;
    for (Evidence& row : flight.recording_evidence)
      row.about = row.about.empty() ? flight.name : of_flight(flight.name, row.about);
    if (!flight.usable() && any_usable) flight.recording_evidence = {left_out(flight)};
    if (!flight.usable() || excited(flight)) continue;
    // What gives no estimate a row spoils none.
    if (any_excited) flight.recording_evidence.clear();
    flight.recording_evidence.push_back(nothing_excited(flight));
  }
  return flights;
}

}  // namespace veridyn::aircraft
