// veridyn camera, where the program was built without OpenCV.
#include "apps/veridyn/command.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::app {

Command camera_command() {
  return {.name = "camera",
          .summary = "where a car is on its track (not in this build: OpenCV was missing)",
          .example = "veridyn camera --help",
          .run = [](const Arguments&) -> int {
            throw InputError("camera", "this program was built without it: OpenCV was missing (run tools/setup.sh)");
          }};
}

}  // namespace veridyn::app
