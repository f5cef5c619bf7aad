#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "veridyn/aircraft/identification/budget/sensor_priors.hpp"
#include "veridyn/aircraft/identification/signals/segments.hpp"
#include "veridyn/aircraft/model/subject.hpp"

namespace veridyn::aircraft {

/// Delays of a vane and of the surfaces of one axis after its manoeuvres, and lags of these surfaces.
struct ManoeuvreDelays {
  std::vector<SensorError> errors;
  Eigen::MatrixXd covariance;  ///< [s^2]
};

/// How late vane, surfaces and accelerometer of an axis are against the gyro, and with what lag surfaces follow, by
/// what its manoeuvres say of the prior: the rows of its coefficients z = X theta + e with X and z at shifted signals,
/// linear about the delays d so far,
///     z - X theta = D d + e,   D = (dX/dd) theta - dz/dd,
/// for all coefficients of the axis with one d, weighted by their residuals. Instruments are the axis's deflections,
/// now and up to a second ago: gusts, noise of the vanes and what a gust does besides are independent of what the pilot
/// chose, so that they widen the result and do not move it (two-stage least squares, Wooldridge 2010, chapter 5; the
/// long-run variance of the moments by Bartlett's weights, Newey & West 1987). Searched from two starts, of which the
/// one that ends with smaller residuals counts: a delay that was aligned wrongly drags others along.
/// @param priors       of the delays, about the stamps as they are; those with sigma 0 are known and left out
/// @param other_start  means from which the search starts once more
[[nodiscard]] ManoeuvreDelays delays_by_manoeuvres(const FlightSignals& signals, const AxisSegments& axis,
                                                   const Subject& subject, std::vector<SensorError> priors,
                                                   std::span<const SensorError> other_start = {});

}  // namespace veridyn::aircraft
