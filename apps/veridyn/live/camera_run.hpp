#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/study_keys.hpp"
#include "veridyn/live/rig/live_replay.hpp"

namespace veridyn::app {

/// A car's motion in a live run, from its inertial sensors and a camera above its track.
struct FusedRun {
  std::string motion_csv;
  std::size_t samples = 0, frames = 0, late = 0, gaps = 0;
  double offset = 0.0, sigma_offset = 0.0;  ///< of the camera's stamps beyond what the shortest way explains [s]
};

/// The keys of `veridyn camera` and `[live.camera]`. @throws InputError in a program without the camera
[[nodiscard]] std::vector<StudyKeys> camera_keys();
/// What was found of the camera's stamps, as keys of a study that begins with it.
[[nodiscard]] std::string camera_delay_toml(const FusedRun& run);
/// Reads `[live.camera.fusion]` where the study has a camera. @throws InputError for what is wrong in it, and in a
/// program without the camera
void check_camera(const Study& study);
/// Sensors and poses entered in the order in which they came in, late poses where they belong. Nothing without both.
[[nodiscard]] std::optional<FusedRun> fused_run(const Study& study, const live::LiveReplay& run);

}  // namespace veridyn::app
