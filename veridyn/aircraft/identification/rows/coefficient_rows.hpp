#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/signals/flight_signals.hpp"
#include "veridyn/aircraft/identification/signals/segments.hpp"
#include "veridyn/aircraft/model/aero_model.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/estimation/regression/regression_data.hpp"

namespace veridyn::aircraft {

/// Terms that a structure search chooses among by default: those of `model`, the coefficient's usual linear
/// ones, and second-order ones: alpha^2, alpha q_n, alpha de, de^2 (longitudinal), alpha beta,
/// alpha p_n, alpha r_n, alpha da, alpha dr, beta^3 (lateral).
[[nodiscard]] std::vector<Term> default_candidates(const CoefficientModel& model);

/// The axis on which a coefficient is identified: CL, CD, Cm longitudinal, the others lateral.
[[nodiscard]] Axis axis_of(Coefficient coefficient);

/// Why the coefficient cannot be computed from these signals at all, or empty.
[[nodiscard]] std::string identification_obstacle(const CoefficientModel& model, const FlightSignals& signals,
                                                  const Subject& subject);

/// W of the coefficient's row [x, z] at grid point k: J Sigma J' of the signals' classical errors; those of Berkson
/// kind enter through z alone.
[[nodiscard]] Eigen::MatrixXd row_error_covariance(const CoefficientModel& model, const FlightSignals& signals,
                                                   std::size_t k, const Subject& subject);

/// Regression rows of a coefficient in the given spans: stride-thinned, rows that miss a signal left out, one segment
/// id a gapless stretch of a span, W from the signals' noise.
/// @param errors  W where it is known, as of signals that hardly differ: it takes most of the time
[[nodiscard]] estimation::RegressionData coefficient_data(const CoefficientModel& model, const FlightSignals& signals,
                                                          std::span<const TimeSpan> spans, const Subject& subject,
                                                          const Eigen::MatrixXd* errors = nullptr);

/// Inside of identification: which samples are rows of a coefficient's regression.
namespace internal {

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

}  // namespace internal
}  // namespace veridyn::aircraft
