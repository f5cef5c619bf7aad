#pragma once

#include <array>

#include "veridyn/core/recording.hpp"

namespace veridyn::aircraft {

/// A recording whose channels `accel_x`, `accel_y`, `accel_z` are what an accelerometer at the centre of gravity would
/// have shown, a - w' x r - w x (w x r), for comparisons with velocity and attitude; as it is where accelerometer or
/// gyro are missing or r is 0. Angular accelerations are central differences of the gyro, whose noise they have: what
/// compares must smooth.
/// @param position r of the accelerometer from the centre of gravity, body axes [m]
[[nodiscard]] Recording with_accelerometer_at_centre(Recording recording, const std::array<double, 3>& position);

}  // namespace veridyn::aircraft
