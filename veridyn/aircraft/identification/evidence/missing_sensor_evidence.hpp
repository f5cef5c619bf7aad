#pragma once

#include "veridyn/aircraft/identification/evidence/checked_flight.hpp"
#include "veridyn/aircraft/identification/signals/segments.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct.hpp"
#include "veridyn/core/recording.hpp"

namespace veridyn::aircraft {

/// Rows of what a recording was made without, and what therefore cannot be told.
///
/// - *No ground velocity*, or no attitude: nothing that the air data could be verified against.
/// - *No airspeed sensor*: the airspeed is ground speed less a wind that is assumed as much as estimated. By how much
///   the slow wind leaves it in doubt widens the intervals of all coefficients.
/// - *No filter*: an airspeed as recorded whose noise is more than 1.5 % of it.
/// - *No vane*: gusts that no sensor feels move the aircraft, which answers them, so that what is left out of the flow
///   angle is not independent of it, and derivatives are biased in a way that no residual shows: by about the ratio of
///   the unknown angle's variance to that of the flow angle in manoeuvres, which is the statistic of the row. Beyond 1
///   % the parameters of the angle's coefficients are no constants of the aircraft; the constant part of the error
///   widens intervals.
[[nodiscard]] CheckedFlight missing_sensor_evidence(const Recording& recording, const Reconstruction& reconstruction,
                                                    const Segments& segments);

}  // namespace veridyn::aircraft
