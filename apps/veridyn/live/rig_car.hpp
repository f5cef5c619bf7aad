#pragma once

#include "apps/veridyn/run/command.hpp"

namespace veridyn::app {

/// `veridyn rig car STUDY`: a scaled car without hardware at the end of a serial line.
[[nodiscard]] Command rig_car_command();

/// `veridyn rig wheel DEVICE`: the guided calibration of a steering wheel with pedals.
[[nodiscard]] Command rig_wheel_command();

}  // namespace veridyn::app
