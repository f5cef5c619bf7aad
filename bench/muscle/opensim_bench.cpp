// The whole arm against the real OpenSim: wall times of OpenSim 4.5.2 on one core of a machine like this one (reference
// e_timings.csv: accuracy 1e-5, median of five) over ours, as counters `OpenSim_ms` and `times_faster`. One thread.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <memory>

#include "bench/muscle/arm26_scenarios.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/simulation/computed_muscle_control.hpp"
#include "veridyn/muscle/simulation/motion_analysis.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"

namespace veridyn::muscle {
namespace {

const std::filesystem::path kShared = veridyn::test::shared_folder();
constexpr std::size_t kMuscles = 6;

std::unique_ptr<MusculoskeletalSystem> arm(benchmark::State& state, const char* file, PathSource paths) {
  if (!std::filesystem::exists(kShared / "data/opensim")) {
    state.SkipWithError("the OpenSim models of ../shared/data are not here");
    return nullptr;
  }
  return std::make_unique<MusculoskeletalSystem>(read_osim(kShared / "data/opensim" / file),
                                                 SystemOptions{.paths = paths});
}

StartState start_of(const Model& model, int number) {
  constexpr std::array<std::array<double, 2>, 3> kStart{{{2.5, 30.0}, {10.0, 30.0}, {0.0, 40.0}}};
  StartState start = default_start(model);
  for (Eigen::Index c = 0; c < 2; ++c) {
    start.q(c) = kStart[static_cast<std::size_t>(number - 1)][static_cast<std::size_t>(c)] * kDegree;
  }
  return start;
}

void compare(benchmark::State& state, double opensim_ms) {
  state.counters["OpenSim_ms"] = opensim_ms;
  // A rate of "OpenSim seconds" is how many times faster we are.
  state.counters["times_faster"] = benchmark::Counter(opensim_ms * 1e-3, benchmark::Counter::kIsIterationInvariantRate);
}

void forward(benchmark::State& state, const char* file, PathSource paths, int number, double opensim_ms) {
  const auto system = arm(state, file, paths);
  if (!system) return;
  const StartState start = start_of(system->model(), number);
  const MuscleControls controls = test::arm26_scenario(number, 0.001);
  Progress progress;
  // A row a step, as OpenSim stores its states.
  const ForwardOptions options{.rate_Hz = 0.0, .accuracy = 1e-5};
  long evaluations = 0;
  MuscleTrajectory t;
  for (auto _ : state) {
    t = simulate_forward(*system, start, controls, options, progress);
    evaluations += t.evaluations;
  }
  const MuscleTrajectory exact =
      simulate_forward(*system, start, controls, {.rate_Hz = 0.0, .accuracy = 1e-11}, progress);
  state.counters["end_error_rad"] = (t.q.row(t.q.rows() - 1) - exact.q.row(exact.q.rows() - 1)).cwiseAbs().maxCoeff();
  state.counters["per_evaluation"] =
      benchmark::Counter(static_cast<double>(evaluations), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  compare(state, opensim_ms);
}

constexpr const char* kThelen = "arm26.osim";
constexpr const char* kMillard = "arm26_millard.osim";
#define FORWARD(name, file, number, opensim_ms)                                            \
  BENCHMARK_CAPTURE(forward, name##_fitted, file, PathSource::kFitted, number, opensim_ms) \
      ->Unit(benchmark::kMillisecond);                                                     \
  BENCHMARK_CAPTURE(forward, name##_exact, file, PathSource::kExact, number, opensim_ms)->Unit(benchmark::kMillisecond)
FORWARD(thelen_s1, kThelen, 1, 57.017);
FORWARD(thelen_s2, kThelen, 2, 143.725);
FORWARD(thelen_s3, kThelen, 3, 116.968);
FORWARD(millard_s1, kMillard, 1, 144.611);
FORWARD(millard_s2, kMillard, 2, 199.999);
FORWARD(millard_s3, kMillard, 3, 141.532);

Motion reference_motion(const Model& model) {
  return make_motion(read_signals(kShared / "reference/opensim/minjerk_elbow.mot"), model);
}

void control(benchmark::State& state, const char* file, PathSource paths, double opensim_ms) {
  const auto system = arm(state, file, paths);
  if (!system) return;
  const Motion motion = reference_motion(system->model());
  Progress progress;
  for (auto _ : state)
    benchmark::DoNotOptimize(
        computed_muscle_control(*system, motion, {.end = 1.02, .rate_Hz = 0.0}, progress).trajectory.steps);
  compare(state, opensim_ms);
}
#define CONTROL(name, file, opensim_ms)                                                                            \
  BENCHMARK_CAPTURE(control, name##_fitted, file, PathSource::kFitted, opensim_ms)->Unit(benchmark::kMillisecond); \
  BENCHMARK_CAPTURE(control, name##_exact, file, PathSource::kExact, opensim_ms)->Unit(benchmark::kMillisecond)
CONTROL(arm26, kThelen, 27104.0);
CONTROL(arm26_load1kg, "arm26_load1kg.osim", 25660.0);
CONTROL(arm26_millard, kMillard, 28265.0);
CONTROL(arm26_millard_load1kg, "arm26_millard_load1kg.osim", 26977.0);

void optimisation(benchmark::State& state, const char* file, PathSource paths, StaticForce force, double opensim_ms) {
  const auto system = arm(state, file, paths);
  if (!system) return;
  const Motion motion = reference_motion(system->model());
  Progress progress;
  const auto time = frame_times(0.0, 1.0, 200.0);
  for (auto _ : state) {
    benchmark::DoNotOptimize(optimise_motion(*system, motion, system->model().default_pose(), time,
                                             {.force = force, .reserve = {1.0, 1.0}}, progress)
                                 .activation.sum());
  }
  compare(state, opensim_ms);
}
BENCHMARK_CAPTURE(optimisation, arm26_exact, kThelen, PathSource::kExact, StaticForce::kAsOpenSim, 2220.0)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(optimisation, arm26_fitted, kThelen, PathSource::kFitted, StaticForce::kAsOpenSim, 2220.0)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(optimisation, arm26_load1kg_exact, "arm26_load1kg.osim", PathSource::kExact, StaticForce::kAsOpenSim,
                  2251.0)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(optimisation, arm26_exact_with_passive, kThelen, PathSource::kExact, StaticForce::kWithPassive,
                  2220.0)
    ->Unit(benchmark::kMillisecond);

void inverse(benchmark::State& state) {
  const auto system = arm(state, kThelen, PathSource::kExact);
  if (!system) return;
  const Motion motion = reference_motion(system->model());
  const auto time = frame_times(0.0, 1.0, 200.0);
  for (auto _ : state)
    benchmark::DoNotOptimize(analyse_motion(*system, motion, system->model().default_pose(), time).moment.sum());
  compare(state, 24.8);
}
BENCHMARK(inverse)->Unit(benchmark::kMillisecond);

void derivative(benchmark::State& state, const char* file, PathSource paths) {
  const auto system = arm(state, file, paths);
  if (!system) return;
  SystemEvaluator<double> evaluator(*system);
  const StateLayout& layout = system->layout();
  std::vector<double> x(layout.size), rate(layout.size), u(kMuscles, 0.1);
  x[0] = 0.1;
  x[1] = 0.7;
  evaluator.set_motion(x.data(), x.data() + 2);
  evaluator.start_muscles(u.data(), x.data());
  for (auto _ : state) benchmark::DoNotOptimize(evaluator.derivative(x.data(), {u, {}}, rate.data()));
}
BENCHMARK_CAPTURE(derivative, thelen_fitted, kThelen, PathSource::kFitted);
BENCHMARK_CAPTURE(derivative, thelen_exact, kThelen, PathSource::kExact);
BENCHMARK_CAPTURE(derivative, millard_fitted, kMillard, PathSource::kFitted);
BENCHMARK_CAPTURE(derivative, millard_exact, kMillard, PathSource::kExact);

}  // namespace
}  // namespace veridyn::muscle
