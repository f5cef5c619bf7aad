#pragma once

#include <span>

#include "veridyn/aircraft/identification/evidence/checked_flight.hpp"
#include "veridyn/aircraft/tracking/flight_tracker.hpp"

namespace veridyn::aircraft {

/// What one coefficient that is followed is judged by at this moment: its tracker's rows and the plausibility of its
/// values. `c` must have a tracker.
[[nodiscard]] std::vector<estimation::Evidence> tracked_evidence(const TrackedCoefficient& c, const Subject& subject);

/// The tracker's estimate with its evidence and grades: rows of the recording, of every coefficient that is followed,
/// and of the plausibility of its values. What must not be taken for physical constants is marked as `identify` marks
/// it: effective or rejected.
/// @param recording rows of the recording; empty: it was not checked, which a row says
[[nodiscard]] estimation::Estimate judged_estimate(const FlightTracker& tracker,
                                                   std::span<const estimation::Evidence> recording);

}  // namespace veridyn::aircraft
