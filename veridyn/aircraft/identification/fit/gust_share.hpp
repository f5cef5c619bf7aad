#pragma once

#include "veridyn/aircraft/identification/budget/sensor_priors.hpp"
#include "veridyn/aircraft/identification/rows/prepared_flight.hpp"
#include "veridyn/aircraft/model/subject.hpp"

namespace veridyn::aircraft {

/// What the air around a flight may do that its model has not: the shares of `AirRates`, by their priors. That of the
/// gusts' turning is measured: pitching and yawing moments are regressed on their terms and, with one factor, on what
/// these terms would have of q_g and r_g.
[[nodiscard]] std::vector<SensorError> air_errors(const PreparedFlight& flight, const Subject& subject,
                                                  const KnownSensors& known);

}  // namespace veridyn::aircraft
