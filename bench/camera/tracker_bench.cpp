// A frame of 1920 x 1080 px from pixels to pose: at 30 frames a second there are 33.3 ms. Frames are rendered before
// the clock starts. And an inertial sample with a frame of the camera every third, 50 ms late: at 100 Hz there are 10
// ms.
#include <benchmark/benchmark.h>

#include <filesystem>
#include <vector>

#include "tests/camera/fusion/simulated_sensors.hpp"
#include "tests/camera/rendered_drive.hpp"
#include "veridyn/camera/fusion/inertial_camera_fusion.hpp"
#include "veridyn/camera/tracking/video_frames.hpp"

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

Calibration calibration() { return fit_camera(testing::grid_points(testing::wide_camera(), 0.2, 0.2, 1)); }

void track_1080p(benchmark::State& state) {
  const std::vector<GreyImage>& all = frames();
  CarTracker tracker(calibration(), {});
  std::size_t count = 0, measured = 0;
  for (auto _ : state) {
    const std::size_t k = count % all.size();
    if (k == 0) {
      state.PauseTiming();
      tracker = CarTracker(calibration(), {});
      state.ResumeTiming();
    }
    measured += tracker.add(static_cast<double>(k) / 30.0, all[k].view()).status == TrackStatus::kMeasured ? 1 : 0;
    ++count;
  }
  state.counters["frames/s"] = benchmark::Counter(static_cast<double>(count), benchmark::Counter::kIsRate);
  state.counters["measured"] = static_cast<double>(measured) / static_cast<double>(count);
}

void track_1080p_from_file(benchmark::State& state) {
  const auto file = std::filesystem::temp_directory_path() / "veridyn_tracker_bench.avi";
  write_video(file, frames(), 30.0);
  std::size_t count = 0, measured = 0;
  for (auto _ : state) {
    VideoFrames video(file);
    CarTracker tracker(calibration(), {});
    while (const auto frame = video.next()) {
      measured += tracker.add(frame->time, frame->image.view()).status == TrackStatus::kMeasured ? 1 : 0;
      ++count;
    }
  }
  std::filesystem::remove(file);
  state.counters["measured"] = static_cast<double>(measured) / static_cast<double>(count);
  state.counters["frames/s"] = benchmark::Counter(static_cast<double>(count), benchmark::Counter::kIsRate);
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
BENCHMARK(track_1080p_from_file)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK(fuse_sample)->Unit(benchmark::kMillisecond);

}  // namespace
