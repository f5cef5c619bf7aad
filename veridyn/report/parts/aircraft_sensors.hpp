#pragma once

#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// The sensors of a flight and what they determine: channels, delays, innovations, observability, sensor errors, and
/// the comparison with a filter that knows the aircraft.
[[nodiscard]] Section sensors_section(const aircraft::PreparedFlight& flight);

}  // namespace veridyn::report
