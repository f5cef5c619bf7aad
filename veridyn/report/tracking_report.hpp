#pragma once

#include "veridyn/aircraft/track_flight.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// The report of `veridyn track`: the parameters as they stand, the changes that were found with the stated rate of
/// false alarms, and per coefficient its parameters with 95 % bands over time, what was excited, and how fast it
/// forgot.
[[nodiscard]] Document tracking_report(const aircraft::FlightStudy& study, const aircraft::TrackedFlight& flight,
                                       const std::string& program);

}  // namespace veridyn::report
