// veridyn camera, where the program was built without OpenCV.
#include "apps/veridyn/live/camera_run.hpp"
#include "apps/veridyn/live/rig_camera.hpp"
#include "apps/veridyn/run/command.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::app {

namespace {

[[noreturn]] void refuse_camera() {
  throw InputError("camera", "this program was built without it: OpenCV was missing (run tools/setup.sh)");
}

int without_camera(const Arguments& /*arguments*/) { refuse_camera(); }

}  // namespace

Command camera_command() {
  return {.name = "camera",
          .summary = "where a car is on its track (not in this build: OpenCV was missing)",
          .example = "veridyn camera --help",
          .run = without_camera};
}

Command rig_camera_command() {
  return {.name = "camera",
          .summary = "a camera above the virtual car (not in this build: OpenCV was missing)",
          .example = "veridyn rig camera --help",
          .run = without_camera};
}

std::vector<StudyKeys> camera_keys() { refuse_camera(); }

void check_camera(const Study& study) {
  if (study.root().table("live").has("camera"))
    study.root().table("live").fail("camera", "needs a program with OpenCV, which this one was built without");
}

std::string camera_delay_toml(const FusedRun& /*run*/) { return {}; }

std::optional<FusedRun> fused_run(const Study& /*study*/, const live::LiveReplay& /*run*/) { return std::nullopt; }

}  // namespace veridyn::app
