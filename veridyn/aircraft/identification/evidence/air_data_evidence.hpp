#pragma once

#include "veridyn/aircraft/identification/budget/sensor_priors.hpp"
#include "veridyn/aircraft/identification/evidence/checked_flight.hpp"
#include "veridyn/aircraft/identification/signals/segments.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct.hpp"
#include "veridyn/aircraft/sensors/air_data_consistency.hpp"

namespace veridyn::aircraft {

/// Does air data agree with ground velocity, attitude, gyro and accelerometer? Rows of the airspeed's scale and of zero
/// and scale of each vane, where the channels that this takes are there. The errors of airspeed, vanes and air density
/// are those of the priors after what was measured of them; without a measurement the priors. Errors of the airspeed
/// that the reconstruction estimated and took off are taken off here too.
/// @param recording  with the vanes' angles of the centre of gravity (`with_corrected_flow`)
[[nodiscard]] CheckedFlight air_data_evidence(const Recording& recording, const Reconstruction& reconstruction,
                                              bool airspeed_is_true, const Segments& segments,
                                              const KnownSensors& known = {});

}  // namespace veridyn::aircraft
