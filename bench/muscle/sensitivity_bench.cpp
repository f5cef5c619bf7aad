// 18 derivatives (F0, L0, LS of six muscles) of a second of arm26 beside the simulation itself: counter `simulations`
// is the ratio of their processor times. Scenario 2 of the reference; with both joints free, and as a task: shoulder
// held.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <filesystem>

#include "bench/muscle/arm26_scenarios.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/identification/muscle_parametric_model.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/simulation/motion_analysis.hpp"

namespace veridyn::muscle {
namespace {

void sensitivities(benchmark::State& state, const char* file, PathSource paths, bool shoulder_held) {
  const std::filesystem::path folder = veridyn::test::shared_folder() / "data/opensim";
  if (!std::filesystem::exists(folder)) {
    state.SkipWithError("the OpenSim models of ../shared/data are not here");
    return;
  }
  SystemOptions options{.paths = paths};
  if (shoulder_held) options.locked.push_back("r_shoulder_elev");
  const MusculoskeletalSystem system(read_osim(folder / file), options);
  std::vector<MuscleParameterName> names;
  for (int m = 0; m < 6; ++m) {
    for (std::size_t f = 0; f < 3; ++f) names.push_back({m, f});
  }
  StartState start = default_start(system.model());
  start.q << 10.0 * kDegree, 30.0 * kDegree;
  const MotionSegment segment{start, test::arm26_scenario(2, 0.001), frame_times(0.0, 1.0, 100.0)};
  const MuscleParametricModel model(system, names, {segment}, 1e-5);
  const auto initial = model.initial_conditions(0);
  Eigen::VectorXd theta(static_cast<Eigen::Index>(names.size() + initial.size()));
  std::vector<Eigen::Index> active;
  for (std::size_t i = 0; i < names.size(); ++i) {
    theta(static_cast<Eigen::Index>(i)) = model.parameters()[i].start;
    active.push_back(static_cast<Eigen::Index>(i));
  }
  for (std::size_t i = 0; i < initial.size(); ++i)
    theta(static_cast<Eigen::Index>(names.size() + i)) = initial[i].start;
  estimation::ModelResponse response;
  // The fastest of many: what others do on the machine is no part of the ratio.
  const auto fastest = [&](std::span<const Eigen::Index> columns) {
    std::clock_t least = 0;
    for (int i = 0; i < 40; ++i) {
      const std::clock_t begin = std::clock();
      benchmark::DoNotOptimize(model.respond(0, theta, columns, response));
      const std::clock_t taken = std::clock() - begin;
      least = i == 0 ? taken : std::min(least, taken);
    }
    return static_cast<double>(least);
  };
  state.counters["simulations"] = fastest(active) / fastest({});
  for (auto _ : state) benchmark::DoNotOptimize(model.respond(0, theta, active, response));
}
#define SENSITIVITIES(name, file)                                                                                   \
  BENCHMARK_CAPTURE(sensitivities, name##_fitted, file, PathSource::kFitted, false)->Unit(benchmark::kMillisecond); \
  BENCHMARK_CAPTURE(sensitivities, name##_exact, file, PathSource::kExact, false)->Unit(benchmark::kMillisecond);   \
  BENCHMARK_CAPTURE(sensitivities, name##_task_fitted, file, PathSource::kFitted, true)                             \
      ->Unit(benchmark::kMillisecond);                                                                              \
  BENCHMARK_CAPTURE(sensitivities, name##_task_exact, file, PathSource::kExact, true)->Unit(benchmark::kMillisecond)
SENSITIVITIES(thelen, "arm26.osim");
SENSITIVITIES(millard, "arm26_millard.osim");

}  // namespace
}  // namespace veridyn::muscle
