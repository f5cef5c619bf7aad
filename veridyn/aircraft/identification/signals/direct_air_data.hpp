#pragma once

#include "veridyn/aircraft/identification/signals/flight_signals.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct.hpp"

namespace veridyn::aircraft {

/// Airspeed and flow angles straight from pitot tube and vanes, in the channels that `prepare_signals` takes from a
/// reconstruction: what an on-board estimator has without a filter. The airspeed goes through the low-pass that
/// `options` prescribe, on its stamps; angles stay raw, they are filtered with everything else. Attitude, ground
/// velocity and flow angles that are not recorded have no channel.
/// @throws InputError when the recording has no airspeed or no gyro
[[nodiscard]] Recording direct_air_data(const Recording& recording, const ReconstructOptions& reconstruct,
                                        const SignalOptions& options);

/// The same in place of a reconstruction (`filter = "none"`), with what its absence costs as warnings.
[[nodiscard]] Reconstruction recorded_motion(const Recording& recording, const ReconstructOptions& reconstruct,
                                             const SignalOptions& options);

}  // namespace veridyn::aircraft
