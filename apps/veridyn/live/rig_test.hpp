#pragma once

#include "apps/veridyn/run/command.hpp"

namespace veridyn::app {

/// `veridyn rig test STUDY`: the platform by hand, and how it follows.
[[nodiscard]] Command rig_test_command();

}  // namespace veridyn::app
