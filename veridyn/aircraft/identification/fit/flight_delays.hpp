#pragma once

#include <string>
#include <vector>

#include "veridyn/aircraft/identification/budget/sensor_priors.hpp"
#include "veridyn/aircraft/identification/rows/prepared_flight.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/aircraft/sensors/delays.hpp"

namespace veridyn::aircraft {

/// Brings vanes and deflections of a flight onto the gyro's clock by its manoeuvres (`delays_by_manoeuvres`), from
/// where the alignment of its recording left them: the means are taken off the stamps whatever their size, the reports
/// say what was found, and what is left of all delays goes into the budget. So do the lags of the surfaces, with their
/// means, which are to be taken off the signals. A surface that jumps between two samples and has no lag beyond chance
/// has neither: its jumps are taken out of the rows. Delays that the study gives without a standard deviation are
/// known; with `automatic = false` all are. Signals have to be prepared again.
void align_by_manoeuvres(PreparedFlight& flight, const Subject& subject, const DelayAlignment& options,
                         const KnownSensors& known);

/// A sentence for each deflection that was found to be a command.
[[nodiscard]] std::vector<std::string> lag_notes(const SensorBudget& budget);

}  // namespace veridyn::aircraft
