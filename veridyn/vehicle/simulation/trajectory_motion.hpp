#pragma once

#include <vector>

#include "veridyn/recording/motion_sample.hpp"
#include "veridyn/vehicle/model/vehicle_trajectory.hpp"

namespace veridyn::vehicle {

/// The motion of the body's centre of gravity, in frame flu: specific force in body axes from the accelerations against
/// the world, angular rates from those of the angles. A model without roll, pitch and heave stays level. Accelerations
/// of heave, roll and pitch are derived from their rates by central differences.
/// @param gravity [m/s^2]
[[nodiscard]] std::vector<recording::MotionSample> motion_samples(const VehicleTrajectory& trajectory, double gravity);

}  // namespace veridyn::vehicle
