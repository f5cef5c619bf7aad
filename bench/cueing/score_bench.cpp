// An hour of driving scored: through algorithm, guard and actuators, organs of balance, figures with their intervals.
#include <benchmark/benchmark.h>

#include <cmath>

#include "veridyn/cueing/score/cueing_score.hpp"
#include "veridyn/cueing/washout/washout_design.hpp"

namespace veridyn::cueing {
namespace {

void hour_scored(benchmark::State& state) {
  std::vector<recording::MotionSample> drive(360'000);
  for (std::size_t k = 0; k < drive.size(); ++k) {
    const double t = 0.01 * static_cast<double>(k);
    drive[k].time = t;
    drive[k].frame = Frame::kFrd;
    drive[k].force = recording::force_at_rest(Frame::kFrd) +
                     Eigen::Vector3d(3.0 * std::sin(0.5 * t) * std::sin(0.13 * t), 5.0 * std::sin(0.4 * t), 0.0);
    drive[k].rate = Eigen::Vector3d(0.05 * std::sin(1.3 * t), 0.0, 0.3 * std::sin(0.4 * t));
  }
  const Platform& platform = built_in_platform("three_axis");
  const auto washout = washout_algorithm("classical").design()->make(platform);
  for (auto _ : state) {
    Progress progress;
    const CueingRun run = drive_platform(drive, *washout, platform, progress);
    benchmark::DoNotOptimize(
        score(run, felt_motion(run, vestibular_model("young_meiry"), usual_thresholds()), platform));
  }
}
BENCHMARK(hour_scored)->Unit(benchmark::kSecond);

}  // namespace
}  // namespace veridyn::cueing
