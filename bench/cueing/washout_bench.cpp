// What a sample costs each washout algorithm, and what a plan costs here and by Ipopt. Drive: forces and turns of a
// winding road with bumps, 100 Hz.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "tests/support/ipopt/ipopt_programme.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/cueing/washout/driver_foresight.hpp"
#include "veridyn/cueing/washout/lap_foresight.hpp"
#include "veridyn/cueing/washout/predictive_washout.hpp"
#include "veridyn/cueing/washout/washout_design.hpp"

namespace veridyn::cueing {
namespace {

std::vector<recording::MotionSample> winding_road(double duration) {
  std::vector<recording::MotionSample> all;
  for (double t = 0.0; t < duration; t += 0.01) {
    recording::MotionSample s;
    s.time = t;
    s.frame = Frame::kFrd;
    const double bumps = 0.8 * std::sin(23.0 * t) + 0.5 * std::sin(41.0 * t + 1.0);
    s.force = recording::force_at_rest(Frame::kFrd) +
              Eigen::Vector3d(4.0 * std::sin(0.5 * t) * std::sin(0.13 * t) + 0.3 * bumps,
                              7.0 * std::sin(0.4 * t) + 3.0 * std::sin(1.1 * t) + 0.3 * bumps, bumps);
    s.rate = Eigen::Vector3d(0.05 * std::sin(1.3 * t), 0.03 * std::sin(0.9 * t), 0.3 * std::sin(0.4 * t));
    s.position = {20.0 * t, 30.0 * std::sin(0.4 * t)};
    s.speed = 20.0;
    s.inputs.steer = -0.03 * std::sin(0.4 * t);
    s.position_from = s.speed_from = s.steer_from = recording::Origin::kMeasured;
    all.push_back(s);
  }
  return all;
}

/// Mean of a sample; worst ones as wall time of single steps, for plans that have to be ready in time.
/// @param from what is foreseen from, where anything is
void step(benchmark::State& state, const std::string& algorithm, const std::string& platform,
          const std::string& from = {}) {
  const auto drive = winding_road(60.0);
  const auto design = washout_algorithm(algorithm).design();
  if (from == "lap") design->foresee_from(LapForesight(drive));
  if (from == "driver") {
    constexpr const char* kCar = "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n";
    design->foresee_from(DriverForesight(
        vehicle::read_vehicle(Study::parse(kCar, "car").root().table("subject"), vehicle::VehicleNeeds::kFourWheel)));
  }
  const auto washout = design->make(built_in_platform(platform));
  std::vector<double> times;
  times.reserve(2'000'000);
  const bool single = algorithm == "mpc";
  for (auto _ : state) {
    washout->reset(drive.front());
    for (std::size_t k = 1; k < drive.size(); ++k) {
      const auto before = single ? std::chrono::steady_clock::now() : std::chrono::steady_clock::time_point();
      benchmark::DoNotOptimize(washout->step(drive[k], 0.01));
      if (single && times.size() < times.capacity())
        times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count());
    }
  }
  state.counters["s_per_step"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(drive.size() - 1),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  if (!single) return;
  std::sort(times.begin(), times.end());
  const auto at = [&](double share) {
    return times[static_cast<std::size_t>(share * static_cast<double>(times.size() - 1))];
  };
  state.counters["p50"] = at(0.5);
  state.counters["p99.9"] = at(0.999);
  state.counters["most"] = times.back();
  const PlanCounts counts = dynamic_cast<const PredictiveWashout&>(*washout).counts();
  state.counters["iterations_per_plan"] = static_cast<double>(counts.iterations) / static_cast<double>(counts.plans);
  state.counters["most_iterations"] = static_cast<double>(counts.most);
  state.counters["late"] = static_cast<double>(counts.late);
  state.counters["classical"] = static_cast<double>(counts.classical);
}

/// Problems of a drive, one in fifty samples.
template <int kStates, int kInputs>
auto problems(const std::string& platform) {
  using Pair = PlannedPair<kStates, kInputs>;
  std::vector<std::pair<typename Pair::Programme, typename Pair::Programme::State>> all;
  Pair pair(PredictiveDesign{}, built_in_platform(platform), 1);
  pair.step(0.0, {}, SampleStep{});
  int k = 0;
  for (const recording::MotionSample& s : winding_road(60.0)) {
    pair.step(0.6 * s.force.y(), {}, 0.01);
    if (++k % 50 == 0) all.emplace_back(pair.programme(), pair.planned_from());
  }
  return all;
}

template <int kStates, int kInputs>
void plan(benchmark::State& state, const std::string& platform) {
  auto all = problems<kStates, kInputs>(platform);
  std::size_t k = 0;
  for (auto _ : state) {
    auto& [programme, from] = all[k++ % all.size()];
    const numerics::ProgrammeResult r = programme.solve(from, {.iterations = 50, .tolerance = 1e-8});
    if (r.end != numerics::ProgrammeEnd::kSolved) state.SkipWithError("not solved");
  }
}

#ifdef VERIDYN_IPOPT
/// The same cold start and accuracy.
template <int kStates, int kInputs>
void plan_by_ipopt(benchmark::State& state, const std::string& platform) {
  const auto all = problems<kStates, kInputs>(platform);
  const auto ipopt = test::ipopt_for_programmes(1e-8);
  std::size_t k = 0;
  for (auto _ : state) {
    const auto& [programme, from] = all[k++ % all.size()];
    Ipopt::SmartPtr<test::IpoptProgramme<kStates, kInputs>> problem =
        new test::IpoptProgramme<kStates, kInputs>(programme, from);
    if (ipopt->OptimizeTNLP(GetRawPtr(problem)) != Ipopt::Solve_Succeeded) state.SkipWithError("not solved");
  }
}
#endif

const bool kRegistered = [] {
  for (const WashoutAlgorithm& a : washout_algorithms()) {
    for (const char* platform : {"three_axis", "hexapod"})
      benchmark::RegisterBenchmark(("step/" + std::string(a.name) + "/" + platform).c_str(), step, std::string(a.name),
                                   platform, "");
  }
  for (const char* from : {"lap", "driver"})
    benchmark::RegisterBenchmark((std::string("step/mpc/three_axis/") + from).c_str(), step, "mpc", "three_axis", from);
  const auto plans = [](const char* name, auto* run, const char* platform) {
    benchmark::RegisterBenchmark((std::string(name) + "/" + platform).c_str(), run, platform);
  };
  plans("plan", &plan<7, 1>, "three_axis");
  plans("plan", &plan<9, 2>, "hexapod");
#ifdef VERIDYN_IPOPT
  plans("plan_by_ipopt", &plan_by_ipopt<7, 1>, "three_axis");
  plans("plan_by_ipopt", &plan_by_ipopt<9, 2>, "hexapod");
#endif
  return true;
}();

}  // namespace
}  // namespace veridyn::cueing
