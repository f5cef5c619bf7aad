#pragma once

#include <cmath>
#include <cstdint>

#include "tests/vehicle/simulated_drive.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::vehicle::testing {

/// Grip falls to 60 % at a time.
inline Recording drive_with_drop(std::uint64_t seed, double duration, double drop_s, double rms = 0.02) {
  using Linear = BicycleModel<double, LinearTyre<double>>;
  const VehicleParameters<double> p = family_car();
  VehicleParameters<double> wet = p;
  wet.C_f *= 0.6;
  wet.C_r *= 0.6;
  const WanderingSteer steer(seed, rms, 0.1, 1.0);
  const VehicleTrajectory t = drive_bicycle<Linear>([&](double at) { return linear_bicycle(at < drop_s ? p : wet); },
                                                    duration, [&](double at) { return steer(at); },
                                                    [](double at) { return 20.0 + 2.0 * std::sin(0.2 * at); });
  return record_drive(t, reference_drive_sensors(), seed);
}

/// Of a car whose stiffnesses are known to some 20 %.
inline VehicleStudy study_of(const Recording& recording) {
  VehicleStudy study;
  study.subject_name = "car";
  study.vehicle = family_car();
  study.vehicle.C_f *= 1.2;
  study.vehicle.C_r *= 0.9;
  study.log.mapped = mapped(recording);
  return study;
}

}  // namespace veridyn::vehicle::testing
