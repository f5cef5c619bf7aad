#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

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

/// Both regressions of a bicycle of small angles at a varying speed, which obeys them without error.
inline DriveRegressions exact_regressions(const VehicleParameters<double>& p) {
  auto bicycle = linear_bicycle(p);
  bicycle.geometry = BicycleGeometry::kSmallAngles;
  const WanderingSteer steer(3, 0.02);
  const VehicleTrajectory drive = drive_bicycle<BicycleModel<double, LinearTyre<double>>>(
      [&](double) { return bicycle; }, 40.0, steer, [](double t) { return 20.0 + 3.0 * std::sin(0.4 * t); });
  const DriveSignals signals = prepare_drive_signals(mapped(record_drive(drive, perfect_sensors(), 1)), {});
  const std::vector<TimeSpan> spans{{2.0, 18.0}, {20.0, 38.0}};
  return drive_regressions(signals, spans, p, 2.0);
}

/// By how much an estimate misses the truth, as a share of it.
inline double relative(const VehicleIdentification& id, VehicleMethod method, const char* name, double truth) {
  return std::abs(id.find(method)->find(name)->value / truth - 1.0);
}

}  // namespace veridyn::vehicle::testing
