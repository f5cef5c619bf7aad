#pragma once

#include <string>

#include "veridyn/core/recording.hpp"

// Not in veridyn::testing, which the tests of the program must not see: there `testing` is that of GoogleTest.
namespace veridyn::test {

/// A drive in frame flu as a car with Autoware records it: Imu, VelocityReport, SteeringReport, of steer, speed,
/// yaw_rate and accel_y.
[[nodiscard]] std::string as_mcap(const Recording& drive);
/// `testing::small_mcap`.
[[nodiscard]] std::string small_drive_mcap();

}  // namespace veridyn::test
