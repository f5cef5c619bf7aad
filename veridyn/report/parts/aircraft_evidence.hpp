#pragma once

#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/report/document/document.hpp"

/// Why a flight's estimates may or may not be trusted, a section each.
namespace veridyn::report {

/// What moved, and which combinations of parameters it determines.
[[nodiscard]] Section excitation_section(const aircraft::FlightAnalysis& analysis);

/// Checks and what the models leave.
[[nodiscard]] Section residual_section(const aircraft::FlightAnalysis& analysis);

/// The models on held-out data.
[[nodiscard]] Section validation_section(const aircraft::FlightAnalysis& analysis);

}  // namespace veridyn::report
