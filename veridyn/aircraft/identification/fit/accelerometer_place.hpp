#pragma once

#include "veridyn/aircraft/identification/budget/sensor_priors.hpp"
#include "veridyn/aircraft/identification/rows/prepared_flight.hpp"
#include "veridyn/aircraft/model/subject.hpp"

namespace veridyn::aircraft {

/// Where the accelerometer is, less where the subject says. Force coefficients cannot tell: a lever arm times an
/// angular acceleration is what makes the moment. But ailerons make hardly any side force: what CY seems to have by
/// them is the height z times the roll acceleration that they give.
[[nodiscard]] std::vector<SensorError> accelerometer_place(const PreparedFlight& flight, const Subject& subject,
                                                           const KnownSensors& known);

}  // namespace veridyn::aircraft
