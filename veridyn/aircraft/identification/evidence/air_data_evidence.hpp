#pragma once

#include <optional>

#include "veridyn/aircraft/identification/evidence/checked_flight.hpp"
#include "veridyn/aircraft/identification/signals/segments.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct.hpp"
#include "veridyn/aircraft/sensors/air_data_consistency.hpp"

namespace veridyn::aircraft {

/// Does air data agree with ground velocity, attitude, gyro and accelerometer? Rows of the airspeed's scale and of zero
/// and scale of each vane; each with what it leaves in doubt. Errors that the reconstruction estimated and took off are
/// taken off here too. No rows without the channels that it takes.
[[nodiscard]] CheckedFlight air_data_evidence(const Recording& recording, const Reconstruction& reconstruction,
                                              bool airspeed_is_true, const Segments& segments);

/// How wrong something that is taken to be `nominal` may be (root mean square), after a measurement of it; none where
/// the recording has no measurement. `before` is the standard deviation without one: of a normal prior about `nominal`,
/// so that a poor measurement leaves that and a good one its own deviation and error:
///     w = before^2 / (before^2 + sigma^2),  doubt^2 = (w (value - nominal))^2 + w sigma^2.
[[nodiscard]] double doubt_of(const std::optional<Determined>& measured, double nominal, double before);

}  // namespace veridyn::aircraft
