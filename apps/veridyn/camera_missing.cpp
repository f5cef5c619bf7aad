// veridyn camera, where the program was built without OpenCV.
#include "apps/veridyn/camera_run.hpp"
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

void check_camera(const Study& study) {
  if (study.root().table("live").has("camera"))
    study.root().table("live").fail("camera", "needs a program with OpenCV, which this one was built without");
}

std::optional<FusedRun> fused_run(const Study& /*study*/, const live::LiveReplay& /*run*/) { return std::nullopt; }

}  // namespace veridyn::app
