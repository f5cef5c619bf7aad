#pragma once

#include <cmath>
#include <cstdint>

#include "tests/vehicle/simulated_drive.hpp"
#include "veridyn/vehicle/identification/vehicle_identification.hpp"

namespace veridyn::vehicle::testing {

/// What is identified of a drive that sensors have recorded, begun from stiffnesses and an inertia that are wrong.
inline VehicleIdentification identify(const VehicleTrajectory& trajectory, const DriveSensorSet& sensors,
                                      std::uint64_t seed, const VehicleIdentifyOptions& options = {},
                                      VehicleParameters<double> start = family_car(), Progress&& progress = {}) {
  start.C_f = 80000.0;
  start.C_r = 80000.0;
  start.I_z = 2000.0;
  const DriveSignalOptions signal_options;
  const DriveSignals signals = prepare_drive_signals(mapped(record_drive(trajectory, sensors, seed)), signal_options);
  const DriveSegments segments = find_drive_segments(signals, {});
  return identify_parameters({signals, segments, start, signal_options, options}, progress);
}

/// By how much an estimate misses the truth, as a share of it.
inline double relative(const VehicleIdentification& id, VehicleMethod method, const char* name, double truth) {
  return std::abs(id.find(method)->find(name)->value / truth - 1.0);
}

}  // namespace veridyn::vehicle::testing
