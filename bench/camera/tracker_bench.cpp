// A frame of 1920 x 1080 px from pixels to pose: at 30 frames a second there are 33.3 ms. Frames are rendered before
// the clock starts. And an inertial sample with a frame of the camera every third, 50 ms late: at 100 Hz there are 10
// ms.
#include <benchmark/benchmark.h>

#include <vector>

#include "tests/camera/fusion/simulated_sensors.hpp"
#include "tests/camera/rendered_drive.hpp"
#include "veridyn/camera/fusion/inertial_camera_fusion.hpp"

namespace {

using namespace veridyn::camera;

const std::vector<GreyImage>& frames() {
  static const std::vector<GreyImage> all = [] {
    OverheadRenderer renderer(testing::disturbed_scene(testing::wide_camera(), 1920, 1080), 1);
    std::vector<GreyImage> rendered;
    for (int k = 0; k < 60; ++k) rendered.push_back(renderer.render(k / 30.0));
    return rendered;
  }();
  return all;
}

void track_1080p(benchmark::State& state) {
  const Calibration calibration = fit_camera(testing::grid_points(testing::wide_camera(), 0.2, 0.2, 1));
  CarTracker tracker(calibration, {});
  const std::vector<GreyImage>& all = frames();
  std::size_t k = 0, measured = 0;
  for (auto _ : state) {
    // Forwards and backwards, so that the car never jumps.
    const std::size_t period = 2 * all.size() - 2, at = k % period;
    const GreyImage& image = all[at < all.size() ? at : period - at];
    const TrackedPose pose = tracker.add(static_cast<double>(k) / 30.0, image.view());
    measured += pose.status == TrackStatus::kMeasured ? 1 : 0;
    ++k;
  }
  state.counters["frames/s"] = benchmark::Counter(static_cast<double>(k), benchmark::Counter::kIsRate);
  state.counters["measured"] = static_cast<double>(measured) / static_cast<double>(k);
}

void fuse_sample(benchmark::State& state) {
  const testing::SimulatedRun run = testing::simulated_run({.seed = 1, .duration_s = 30.0});
  std::size_t samples = 0;
  for (auto _ : state) {
    InertialCameraFusion fusion({});
    std::size_t frame = 0;
    for (const testing::InertialSample& s : run.inertial) {
      while (frame < run.frames.size() && run.frames[frame].arrival <= s.time) {
        const testing::CameraSample& f = run.frames[frame++];
        fusion.add_camera(f.stamp, f.pose, f.covariance);
      }
      fusion.add_inertial(s.time, s.rate, s.force);
    }
    benchmark::DoNotOptimize(fusion.now());
    samples += run.inertial.size();
  }
  state.counters["samples/s"] = benchmark::Counter(static_cast<double>(samples), benchmark::Counter::kIsRate);
}

BENCHMARK(track_1080p)->Unit(benchmark::kMillisecond);
BENCHMARK(fuse_sample)->Unit(benchmark::kMillisecond);

}  // namespace
