#pragma once

#include "veridyn/aircraft/identification/flight_signals.hpp"

namespace veridyn::aircraft {

/// Airspeed and flow angles straight from pitot tube and vanes, in the channels that `prepare_signals` takes from a
/// reconstruction: what an on-board estimator has without a filter. The airspeed goes through the low-pass that
/// `options` prescribe, on its stamps; angles stay raw, they are filtered with everything else.
/// @throws InputError when the recording has no pitot tube or lacks what `reconstruct` needs
[[nodiscard]] Recording direct_air_data(const Recording& recording, const ReconstructOptions& reconstruct,
                                        const SignalOptions& options);

}  // namespace veridyn::aircraft
