#pragma once

#include <vector>

#include "veridyn/aircraft/identification/flight_evidence.hpp"
#include "veridyn/aircraft/identification/segments.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct.hpp"

namespace veridyn::aircraft {

/// Does the recording of a flight agree with itself and with physics? Inertial sensors against velocity and attitude,
/// air data against ground velocity, sensors against the reconstruction, gusts against their model.
[[nodiscard]] std::vector<FlightEvidence> recording_evidence(const Recording& recording,
                                                             const Reconstruction& reconstruction,
                                                             const ReconstructOptions& options,
                                                             const Segments& segments);

}  // namespace veridyn::aircraft
