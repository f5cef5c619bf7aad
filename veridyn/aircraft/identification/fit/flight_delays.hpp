#pragma once

#include "veridyn/aircraft/identification/budget/sensor_priors.hpp"
#include "veridyn/aircraft/identification/rows/prepared_flight.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/aircraft/sensors/delays.hpp"

namespace veridyn::aircraft {

/// Brings vanes and deflections of a flight onto the gyro's clock by its manoeuvres (`delays_by_manoeuvres`), from
/// where the alignment of its recording left them: the means are taken off the stamps whatever their size, the reports
/// say what was found, and what is left of all delays goes into the budget. Delays that the study gives without a
/// standard deviation are known; with `automatic = false` all are. Signals have to be prepared again.
void align_by_manoeuvres(PreparedFlight& flight, const Subject& subject, const DelayAlignment& options,
                         const KnownSensors& known);

}  // namespace veridyn::aircraft
