#pragma once

#include <array>
#include <span>

#include "veridyn/aircraft/identification/budget/sensor_priors.hpp"
#include "veridyn/aircraft/identification/evidence/checked_flight.hpp"
#include "veridyn/aircraft/identification/signals/segments.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct.hpp"
#include "veridyn/aircraft/sensors/delays.hpp"

namespace veridyn::aircraft {

/// Does the recording of a flight agree with itself and with physics? Samples, inertial sensors against velocity and
/// attitude, clocks, air data against ground velocity and against gyro and accelerometer, ranges of deflections,
/// sensors against the reconstruction, gusts against their model.
/// @param delays   what the alignment of the clocks found
/// @param known    what the study knows of the sensors: the priors of their errors
/// @param threads  0: as many as the machine has
/// @param imu_position  of the accelerometer, which is compared as if it was at the centre of gravity [m]
[[nodiscard]] CheckedFlight recording_evidence(const Recording& recording, const Reconstruction& reconstruction,
                                               const ReconstructOptions& options, const Segments& segments,
                                               std::span<const DelayReport> delays = {}, int threads = 0,
                                               const KnownSensors& known = {},
                                               const std::array<double, 3>& imu_position = {});

}  // namespace veridyn::aircraft
