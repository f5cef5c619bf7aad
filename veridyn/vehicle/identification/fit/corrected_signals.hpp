#pragma once

#include <Eigen/Core>

#include "veridyn/vehicle/identification/signals/drive_signals.hpp"

namespace veridyn::vehicle {

/// The signals without what output error found of their sensors (`theta`: a value for each DriveUnknown): steering,
/// yaw rate and accel_y in the time of the wheels, the accelerometer's place as it was found. Of use to what has no
/// such unknowns, as regressions.
[[nodiscard]] DriveSignals corrected_signals(DriveSignals signals, const Eigen::VectorXd& theta);

}  // namespace veridyn::vehicle
