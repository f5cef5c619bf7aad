// How many times faster than time the four-wheel model drives: reference manoeuvre, Runge-Kutta steps of 1 ms, one
// core.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <filesystem>

#include "tests/support/folders.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/vehicle/model/four_wheel_models.hpp"
#include "veridyn/vehicle/simulation/vehicle_simulation.hpp"
#include "veridyn/vehicle/tyre/fiala_tyre.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"
#include "veridyn/vehicle/tyre/simple_magic_formula.hpp"
#include "veridyn/vehicle/tyre/tir_reader.hpp"

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

/// The prototype on road springs, at a speed at which all tyres hold: the reference manoeuvre at 20 m/s needs 1.2 g.
template <typename Tyre>
void drive(benchmark::State& state, const PerWheel<Tyre>& tyres) {
  const bool longitudinal = state.range(0) != 0;
  VehicleParameters<double> p;
  p.K_sf = p.K_sr = 40000.0;
  p.C_sf = p.C_sr = 3000.0;
  p.K_tf = p.K_tr = 200000.0;
  FourWheelOptions options;
  if (longitudinal) options.longitudinal.emplace();
  const FourWheelModel<double, Tyre> model(p, tyres, options);
  ReferenceDriver driver;
  if (longitudinal) driver.torque = 120.0;
  const SimulationOptions simulation{.speed = 12.0};
  Progress progress;
  double driven = 0.0;
  for (auto _ : state) {
    const VehicleTrajectory out = simulate(model, driver, nullptr, simulation, progress);
    if (out.end != DriveEnd::kCompleted) state.SkipWithError(out.message().c_str());
    driven += out.end_time;
  }
  state.counters["times_real_time"] = benchmark::Counter(driven, benchmark::Counter::kIsRate);
}

template <typename Tyre>
void drive(benchmark::State& state, Tyre front, Tyre rear) {
  const VehicleParameters<double> p;
  front.stiffness = p.C_f;
  rear.stiffness = p.C_r;
  drive<Tyre>(state, {front, front, rear, rear});
}

void BM_LinearTyre(benchmark::State& state) { drive(state, LinearTyre<double>{}, LinearTyre<double>{}); }
void BM_FialaTyre(benchmark::State& state) { drive(state, FialaTyre<double>{}, FialaTyre<double>{}); }
void BM_SimpleMagicFormula(benchmark::State& state) {
  drive(state, SimpleMagicFormulaTyre<double>{}, SimpleMagicFormulaTyre<double>{});
}
/// A whole tyre file, PAC2002 with combined slip; skipped where the shared data are not there.
void BM_MagicFormula(benchmark::State& state) {
  const std::filesystem::path file = test::shared_folder() / "data/vehicle/chrono/Sedan_Pac02Tire.tir";
  if (!std::filesystem::exists(file)) {
    state.SkipWithError("no shared data");
    return;
  }
  const TirFile tir = read_tir(file);
  const auto left = tir.on(TyreSide::kLeft), right = tir.on(TyreSide::kRight);
  drive<MagicFormulaTyre<double>>(state, {left, right, left, right});
}
void BM_LinearTyreBicycle(benchmark::State& state) {
  const VehicleParameters<double> p;
  const BicycleModel<double, LinearTyre<double>> model{p, {.stiffness = p.C_f}, {.stiffness = p.C_r}};
  ReferenceDriver driver;
  Progress progress;
  double driven = 0.0;
  for (auto _ : state) driven += simulate(model, driver, {}, progress).end_time;
  state.counters["times_real_time"] = benchmark::Counter(driven, benchmark::Counter::kIsRate);
}

BENCHMARK(BM_LinearTyre)->ArgName("longitudinal")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_FialaTyre)->ArgName("longitudinal")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_SimpleMagicFormula)->ArgName("longitudinal")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_MagicFormula)->ArgName("longitudinal")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_LinearTyreBicycle)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace veridyn::vehicle
