// Filter and smoother over one hour at 100 Hz (360 000 steps, 14 states; GPS 20 Hz, pitot, two vanes and attitude at
// 100 Hz). Target: 5 s on one core, 500 MB with all results.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include "tests/aircraft/reconstruction/reconstruct_flight.hpp"

namespace {

void reconstruct_one_hour(benchmark::State& state) {
  const auto flight = veridyn::aircraft::testing::make_flight({.duration = 3600.0});
  veridyn::aircraft::ReconstructOptions options;
  options.sensors = veridyn::aircraft::NoiseSource::kReference;
  options.turbulence = veridyn::aircraft::named_turbulence("low_moderate");
  veridyn::Progress quiet;
  for (auto _ : state) {
    benchmark::DoNotOptimize(veridyn::aircraft::reconstruct(flight.recording, options, quiet));
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  state.counters["peak_MB"] = static_cast<double>(usage.ru_maxrss) / 1024.0;
}
BENCHMARK(reconstruct_one_hour)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
