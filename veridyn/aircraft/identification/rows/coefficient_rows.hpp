#pragma once

#include <vector>

#include "veridyn/aircraft/identification/signals/flight_signals.hpp"
#include "veridyn/aircraft/model/aero_model.hpp"
#include "veridyn/estimation/regression/regression_data.hpp"

/// Inside of identification: which samples are rows of a coefficient's regression.
namespace veridyn::aircraft::internal {

/// The signals that regressand and regressors of a coefficient need.
[[nodiscard]] std::vector<FlightSignal> needed_signals(const CoefficientModel& model);

/// Whether a sample has them all.
[[nodiscard]] bool complete(const FlightSample<double>& sample, const std::vector<FlightSignal>& needed);

/// Deflections that jump between two samples are known to half a sample only, and aerodynamic moments and rates answer
/// the moment at which they did. The effect of that on the filtered rows is an impulse through the filter: what such
/// impulses, one a jump, explain is taken out of every column of [X, z] (Frisch & Waugh 1933; their sizes are nuisance
/// parameters). Without it, damping in roll comes out up to 8 % off where the roll mode is as fast as 20 rad/s and
/// deflections are sampled at 100 Hz. Nothing is done where there is less than a jump in ten rows to spare.
/// @param rows grid points of the rows of `data`, ascending
void take_out_jumps(const CoefficientModel& model, const FlightSignals& signals, const std::vector<std::size_t>& rows,
                    estimation::RegressionData& data);

}  // namespace veridyn::aircraft::internal
