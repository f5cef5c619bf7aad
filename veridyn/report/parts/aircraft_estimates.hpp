#pragma once

#include <string_view>

#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/report/document/document.hpp"

/// What a flight's analysis says about coefficients and parameters, a section each. A section without blocks has
/// nothing to say and is not shown.
namespace veridyn::report {

/// Whether its parameters may be shown as the aircraft's.
[[nodiscard]] bool identified(const aircraft::CoefficientResult& result);

/// Verdict and reason of each coefficient.
[[nodiscard]] Section coefficients_section(const aircraft::FlightAnalysis& analysis);

/// Estimators other than regression; no blocks when none was requested.
[[nodiscard]] Section other_estimators_section(const aircraft::FlightAnalysis& analysis);

/// How the terms were chosen; no blocks when the subject's were taken.
[[nodiscard]] Section structure_section(const aircraft::FlightAnalysis& analysis);

/// Error of one measured coefficient by source.
[[nodiscard]] Section uncertainty_section(const aircraft::UncertaintyReport& report);

}  // namespace veridyn::report
