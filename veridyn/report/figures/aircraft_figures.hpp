#pragma once

#include <optional>
#include <vector>

#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// Airspeed, alpha, beta and wind with 95 % bands over what was measured (and the truth of a simulated flight), and
/// the inputs, with the segments shaded; how far from the information bound, where the truth is known.
[[nodiscard]] Section flight_section(const aircraft::FlightStudy& study, const aircraft::PreparedFlight& flight);

/// The first screen: measured and modelled coefficients on what was held out (of all flights one after the other), a
/// figure an axis; on what was identified from where nothing was held out. What is effective has a model too, what is
/// rejected has none.
/// @param given  of a given estimate, which has not seen any of it
[[nodiscard]] std::vector<TimeSeries> coefficient_lead(const aircraft::FlightAnalysis& analysis, bool given);

/// From take-off to landing with a margin, so that all that was used is in it; nothing where the aircraft does not fly.
[[nodiscard]] std::optional<Window> flown_range(const aircraft::PreparedFlight& flight);

/// Measured and modelled coefficients over time.
[[nodiscard]] Section coefficient_series_section(const aircraft::FlightAnalysis& analysis);

/// Predicted against measured airspeed, alpha and beta, the stretches held out side by side.
[[nodiscard]] std::vector<TimeSeries> validation_figures(const aircraft::Validation& validation);

/// Autocorrelation of a coefficient's residual over lag [s], with the bound of white noise.
[[nodiscard]] XYPlot residual_autocorrelation_plot(const aircraft::CoefficientResult& result);
/// Normal probability plot of a coefficient's residual.
[[nodiscard]] XYPlot residual_normal_plot(const aircraft::CoefficientResult& result);

}  // namespace veridyn::report
