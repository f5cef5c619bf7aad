#pragma once

#include <vector>

#include "veridyn/aircraft/identification/flight_signals.hpp"
#include "veridyn/aircraft/model/aero_model.hpp"

/// Inside of identification: which samples are rows of a coefficient's regression.
namespace veridyn::aircraft::internal {

/// The signals that regressand and regressors of a coefficient need.
[[nodiscard]] std::vector<FlightSignal> needed_signals(const CoefficientModel& model);

/// Whether a sample has them all.
[[nodiscard]] bool complete(const FlightSample<double>& sample, const std::vector<FlightSignal>& needed);

}  // namespace veridyn::aircraft::internal
