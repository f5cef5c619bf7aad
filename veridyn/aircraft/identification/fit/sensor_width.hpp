#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/budget/sensor_error.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/result/parameter.hpp"

/// What errors of sensors that a recording cannot exclude do to the parameters of a coefficient, and to their
/// intervals. Like mass and geometry, such an error is the same in every row: it does not average out and shows in no
/// residual.
namespace veridyn::aircraft {

/// Change of the parameters per standard deviation of each independent error (`root_of_correlation`), in the places of
/// `place_of` [n x kSensorErrors]: the signal is changed and the parameters estimated again, linearly about `theta`.
/// Errors that the coefficient does not rest on, and what cannot be estimated again, count for nothing.
/// @param estimate parameters of the regression on the signals given; empty where that fails
[[nodiscard]] Eigen::MatrixXd sensor_sensitivity(const FlightSignals& signals, const SensorBudget& budget,
                                                 Coefficient coefficient, const Eigen::VectorXd& theta,
                                                 const std::function<Eigen::VectorXd(const FlightSignals&)>& estimate);

/// Standard deviations that make up a parameter's: their squares add up.
struct IntervalParts {
  Eigen::VectorXd noise;     ///< of the sensors, of gusts, what the model lacks, and scatter between parts or flights
  Eigen::VectorXd air_data;  ///< scales and zeros of airspeed, vanes, accelerometer and air density
  Eigen::VectorXd delays;    ///< of vanes, deflections, airspeed and accelerometer; lags of the surfaces
  Eigen::VectorXd body;      ///< mass, geometry and inertia; the accelerometer's place
};

/// @param sensors,body  changes of the parameters per standard deviation, by `sensor_sensitivity` and
/// `body_sensitivity`
[[nodiscard]] IntervalParts interval_parts(const Eigen::VectorXd& noise, const Eigen::MatrixXd& sensors,
                                           const Eigen::MatrixXd& body);

/// The row that says which intervals are mostly those of the sensors, by their share of the variance: "not verified"
/// where it is more than half, else passed. Grades do not depend on it.
[[nodiscard]] estimation::Evidence sensor_share_row(const std::string& coefficient,
                                                    std::span<const estimation::Parameter> parameters,
                                                    const IntervalParts& parts);

}  // namespace veridyn::aircraft
