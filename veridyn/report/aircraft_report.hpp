#pragma once

#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// What a report says besides the analysis.
struct AircraftReportContext {
  std::string program;  ///< "veridyn 0.1.0"
  std::string command = "identify";
};

/// The report of `veridyn identify` and `veridyn validate`: verdict in a pilot's words, parameters of every method with
/// intervals, flight with 95 % bands, coefficients measured against modelled, residuals, excitation, validation,
/// sensors, and how it was done. Values of rejected coefficients stand only in a separate, folded section.
[[nodiscard]] Document identification_report(const aircraft::FlightStudy& study,
                                             const aircraft::FlightAnalysis& analysis,
                                             const AircraftReportContext& context);

/// The report of `veridyn reconstruct`: the flight with bands, innovations, observability.
[[nodiscard]] Document reconstruction_report(const aircraft::FlightStudy& study,
                                             const aircraft::FlightAnalysis& analysis,
                                             const AircraftReportContext& context);

}  // namespace veridyn::report
