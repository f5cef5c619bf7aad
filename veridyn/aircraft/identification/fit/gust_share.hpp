#pragma once

#include "veridyn/aircraft/identification/budget/sensor_priors.hpp"
#include "veridyn/aircraft/identification/rows/prepared_flight.hpp"
#include "veridyn/aircraft/model/subject.hpp"

namespace veridyn::aircraft {

/// What p_g, which no sensor shows, would be by MIL-F-8785C in the turbulence that the reconstruction found, and how an
/// aircraft with the roll mode that rolling moment and p imply answers it: `AirRates::gust_roll`, `answered_roll`. p_g
/// is of first order, exp(-|t|/T), and so is the answer, with time constant tau: what of the variance of p is no motion
/// against the air is -E[p p_g] = sigma_p^2 T/(T + tau). T is the mean (geometric) of those of MIL-F-8785C and of
/// MIL-HDBK-1797, tau that of the Cl_p that comes out with it.
void know_gusts_across(PreparedFlight& flight, const Subject& subject);

/// What the air around a flight may do that its model has not: the shares of `AirRates`, by their priors. Those of the
/// gusts along the aircraft are measured: pitching and yawing moment are regressed on their terms and, with one factor,
/// on what these terms would have of q_g or r_g. That of p_g is measured by what the rolling moment has beyond the
/// noise of the sensors.
[[nodiscard]] std::vector<SensorError> air_errors(const PreparedFlight& flight, const Subject& subject,
                                                  const KnownSensors& known);

}  // namespace veridyn::aircraft
