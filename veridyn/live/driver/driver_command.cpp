#include "veridyn/live/driver/driver_command.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/error.hpp"

namespace veridyn::live {

void DriverCommandOptions::validate() const {
  range.validate();
  if (!(steering_ratio > 0.0)) throw InputError("steering_ratio", fmt::format("is {}; must be > 0", steering_ratio));
  if (!(reverse_share >= 0.0 && reverse_share <= 1.0))
    throw InputError("reverse_share", fmt::format("is {}; must be from 0 to 1", reverse_share));
}

CarCommand car_command(const DriverInput& input, const DriverCommandOptions& options) {
  CarCommand command;
  command.steering =
      std::clamp(input.steering / options.steering_ratio, -options.range.steering, options.range.steering);
  command.brake = std::clamp(input.brake, 0.0, 1.0);
  const double force = std::clamp(input.throttle, 0.0, 1.0) * options.range.drive_force;
  if (!(command.brake > 0.0)) command.drive_force = input.reverse ? -options.reverse_share * force : force;
  return command;
}

}  // namespace veridyn::live
