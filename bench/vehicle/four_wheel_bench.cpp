// How many times faster than time the four-wheel model drives: reference manoeuvre, Runge-Kutta steps of 1 ms, one
// core.
#include <benchmark/benchmark.h>

#include <algorithm>

#include "veridyn/core/progress.hpp"
#include "veridyn/vehicle/linear_tyre.hpp"
#include "veridyn/vehicle/vehicle_simulation.hpp"

namespace veridyn::vehicle {
namespace {

struct ReferenceDriver : Driver {
  double torque = 0.0;
  [[nodiscard]] Controls controls(double t) const override {
    constexpr double kFiveDegrees = 0.08726646259971647;
    const double steer = kFiveDegrees * std::min(std::clamp(t - 2.0, 0.0, 1.0), std::clamp(16.0 - t, 0.0, 1.0));
    return {.steer = steer, .drive_torque = torque};
  }
};

template <typename Tyre>
void drive(benchmark::State& state, const Tyre& front, const Tyre& rear, bool longitudinal) {
  FourWheelOptions options;
  if (longitudinal) options.longitudinal.emplace();
  const FourWheelModel<double, Tyre> model({}, {front, front, rear, rear}, options);
  ReferenceDriver driver;
  if (longitudinal) driver.torque = 400.0;
  const SimulationOptions simulation;
  Progress progress;
  double driven = 0.0;
  for (auto _ : state) {
    const VehicleTrajectory out = simulate(model, driver, nullptr, simulation, progress);
    if (out.end != SimulationEnd::kCompleted) state.SkipWithError(out.message().c_str());
    driven += out.end_time;
  }
  state.counters["times_real_time"] = benchmark::Counter(driven, benchmark::Counter::kIsRate);
}

void BM_LinearTyres(benchmark::State& state) {
  const VehicleParameters<double> p;
  drive<LinearTyre<double>>(state, {.stiffness = p.C_f}, {.stiffness = p.C_r}, state.range(0) != 0);
}
BENCHMARK(BM_LinearTyres)->ArgName("longitudinal")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace veridyn::vehicle
