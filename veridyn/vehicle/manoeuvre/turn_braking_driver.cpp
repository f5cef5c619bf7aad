#include "veridyn/vehicle/manoeuvre/turn_braking_driver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {

TurnBrakingDriver::TurnBrakingDriver(std::unique_ptr<Driver> before, const TurnBrakingOptions& options)
    : before_(std::move(before)), options_(options) {
  VERIDYN_ASSERT(before_ != nullptr);
  const auto require = [](double value, const char* name) {
    if (!(value > 0.0 && value < kInfinity))
      throw InputError("driver", fmt::format("{} is {:g}; must be > 0", name, value));
  };
  require(options.brake_time, "brake_time");
  require(options.brake_torque, "brake_torque");
  require(options.rise_time, "rise_time");
}

void TurnBrakingDriver::look(double time, const PlanarMotion& motion) {
  if (time < options_.brake_time) before_->look(time, motion);
}

Controls TurnBrakingDriver::controls(double time) const {
  if (time < options_.brake_time) return before_->controls(time);
  const double pressed = std::min((time - options_.brake_time) / options_.rise_time, 1.0);
  return {.steer = before_->controls(options_.brake_time).steer, .brake_torque = pressed * options_.brake_torque};
}

}  // namespace veridyn::vehicle
