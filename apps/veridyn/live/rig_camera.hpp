#pragma once

#include "apps/veridyn/run/command.hpp"

namespace veridyn::app {

/// `veridyn rig camera`: a camera above the virtual car.
[[nodiscard]] Command rig_camera_command();

}  // namespace veridyn::app
