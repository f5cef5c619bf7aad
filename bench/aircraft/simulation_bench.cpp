#include <benchmark/benchmark.h>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/aircraft/simulation/simulation.hpp"

namespace {

// A whole flight with pilot, turbulence and the reference sensors: "realtime" is simulated time over wall time.
void simulate_flight(benchmark::State& state) {
  veridyn::aircraft::SimulationOptions options;
  options.subject = veridyn::aircraft::builtin_subject("unatrap");
  options.duration = 60.0;
  options.turbulence = veridyn::aircraft::dryden_settings("low_moderate", "bench");
  veridyn::Progress silent;
  for (auto _ : state) benchmark::DoNotOptimize(veridyn::aircraft::simulate(options, silent));
  const double flown = static_cast<double>(state.iterations()) * options.duration;
  state.counters["steps"] = benchmark::Counter(flown / options.step, benchmark::Counter::kIsRate);
  state.counters["realtime"] = benchmark::Counter(flown, benchmark::Counter::kIsRate);
}
BENCHMARK(simulate_flight)->Unit(benchmark::kMillisecond);

}  // namespace
