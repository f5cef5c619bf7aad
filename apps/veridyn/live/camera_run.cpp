// The camera in a live run: its poses fused with the car's inertial sensors.
#include "apps/veridyn/live/camera_run.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "veridyn/camera/camera_keys.hpp"
#include "veridyn/camera/fusion/fused_drive.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::camera;

FusionOptions fusion_of(const Study& study) {
  const StudyTable table = study.root().table("live").table("camera").table_or_empty("fusion");
  FusionOptions options = FusionOptions::keys().read(table);
  table.finish();
  return options;
}

}  // namespace

std::vector<StudyKeys> camera_keys() { return camera::study_keys(); }

std::string camera_delay_toml(const FusedRun& run) {
  // The shortest way, beyond which the offset counts, is another one in each run, by some milliseconds.
  constexpr double kBetweenRuns_s = 0.005;
  return fmt::format(
      "\n# How late the camera's stamps are beyond the shortest way, found with a standard deviation of {:.6f} s: a "
      "study "
      "that\n# has this begins with it.\n[live.camera.fusion]\noffset = {:.6f}\noffset_sigma = {:.6f}\n",
      run.sigma_offset, run.offset, std::hypot(run.sigma_offset, kBetweenRuns_s));
}

void check_camera(const Study& study) {
  if (!study.root().table("live").has("camera")) return;
  static_cast<void>(fusion_of(study));
}

std::optional<FusedRun> fused_run(const Study& study, const live::LiveReplay& run) {
  if (!run.study.camera || !run.car || run.car->inertial.empty() || run.car->seen.empty()) return std::nullopt;
  InertialCameraFusion fusion(fusion_of(study));
  const auto& seen = run.car->seen;
  FusedRun out;
  std::vector<FusedMotion> motions;
  std::size_t next = 0, samples = 0;
  const auto enter = [&] {
    for (; next < seen.size() && seen[next].after <= samples; ++next)
      out.frames += fusion.add_camera(seen[next].stamp, seen[next].pose, seen[next].covariance) ? 1 : 0;
  };
  enter();
  for (const auto& felt : run.car->inertial) {
    fusion.add_inertial(felt.time, felt.rate, felt.force);
    ++samples;
    enter();
    if (const auto now = fusion.now()) motions.push_back(*now);
  }
  if (motions.empty()) return std::nullopt;
  out.late = fusion.too_late();
  out.gaps = fusion.gaps();
  out.samples = motions.size();
  out.offset = motions.back().offset;
  out.sigma_offset = motions.back().sigma(InertialModel::kOffset);
  out.motion_csv = to_csv(motions);
  return out;
}

}  // namespace veridyn::app
