#pragma once

#include "veridyn/live/driver/wheel_calibration.hpp"
#include "veridyn/live/teleoperation/car_command.hpp"

namespace veridyn::live {

/// How the driver's wheel and pedals become a command of the car.
struct DriverCommandOptions {
  CommandRange range = {};
  double steering_ratio = 13.1;  ///< angle of the steering wheel by that of the road wheels; 450 deg make 0.6 rad
  double reverse_share = 0.5;    ///< of the drive force, backward

  /// @throws InputError where the ratio is not above zero or the share not from 0 to 1
  void validate() const;
};

/// Always within the range. Brake and throttle together brake: the drive force is zero while the brake is pressed.
[[nodiscard]] CarCommand car_command(const DriverInput& input, const DriverCommandOptions& options);

}  // namespace veridyn::live
