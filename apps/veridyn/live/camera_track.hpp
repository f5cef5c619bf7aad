#pragma once

#include "apps/veridyn/run/command.hpp"

namespace veridyn::app {

/// `veridyn camera track`: the poses of a car in a video file, or before a camera until it is told to end.
[[nodiscard]] Command camera_track_command();

}  // namespace veridyn::app
