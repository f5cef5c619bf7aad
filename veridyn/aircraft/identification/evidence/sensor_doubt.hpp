#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/evidence/checked_flight.hpp"
#include "veridyn/aircraft/identification/signals/flight_signals.hpp"
#include "veridyn/estimation/result/parameter.hpp"

/// What errors of air data that a recording cannot exclude would do to the parameters of a coefficient.
///
/// Like mass and geometry, a wrong scale is the same in every row: it does not average out and shows in no residual.
/// Unlike them it is partly measured by the recording itself, on the headings and in the manoeuvres that were flown. It
/// is stated alongside the interval and not added to it: the interval says what noise and turbulence leave if air data
/// are right, which a calibration can establish; the doubt says what is left without one. Where there is no sensor to
/// calibrate, what the reconstruction leaves in doubt widens the interval (`SignalDoubt::in_interval`).
namespace veridyn::aircraft {

/// The signals as they would be with an error of so many standard deviations.
[[nodiscard]] FlightSignals with_changed(FlightSignals signals, const SignalDoubt& doubt, double deviations);

/// Change of the parameters per standard deviation of each doubt, a column a doubt: the signal is changed and the
/// parameters estimated again, linearly about `theta`. What cannot be estimated again counts for nothing. A thrust that
/// was computed from the airspeed stays.
/// @param estimate parameters of the regression on the signals given; empty where that fails
[[nodiscard]] Eigen::MatrixXd doubt_sensitivity(const FlightSignals& signals, std::span<const SignalDoubt> doubts,
                                                const Eigen::VectorXd& theta,
                                                const std::function<Eigen::VectorXd(const FlightSignals&)>& estimate);

/// The row that states doubts alongside intervals: "not verified" where one is larger than its parameter's standard
/// error, which it names, else passed. Grades do not depend on it.
[[nodiscard]] estimation::Evidence doubt_row(const std::string& coefficient,
                                             std::span<const estimation::Parameter> parameters,
                                             const Eigen::VectorXd& doubt);

/// The parameters with status weak for what is identified but, with its doubt, has an interval of 95 % that reaches
/// further than estimation::kWeakShare of the value.
[[nodiscard]] std::vector<estimation::Parameter> weak_by_doubt(std::vector<estimation::Parameter> parameters,
                                                               const Eigen::VectorXd& doubt);

}  // namespace veridyn::aircraft
