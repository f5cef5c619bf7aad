#pragma once

#include <vector>

#include "veridyn/recording/motion_sample.hpp"
#include "veridyn/vehicle/model/vehicle_trajectory.hpp"

namespace veridyn::vehicle {

/// The motion of the body's centre of gravity, see `motion_sample`. A model without roll, pitch and heave stays level.
/// @param gravity [m/s^2]; @param grade of the road, where the drive had one [rad]
[[nodiscard]] std::vector<recording::MotionSample> motion_samples(const VehicleTrajectory& trajectory, double gravity,
                                                                  double grade = 0.0);

}  // namespace veridyn::vehicle
