// Muscles of arm26 in random states as they occur in motion: rates, forces, equilibrium, curves; time per muscle.
#include <benchmark/benchmark.h>
#include <ceres/jet.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/actuator/muscle_group.hpp"
#include "veridyn/muscle/simulation/static_optimization.hpp"

namespace {
using namespace veridyn::muscle;
using veridyn::kPi;

constexpr std::size_t kStates = 256, kMuscles = 6;
constexpr std::array<std::array<double, 4>, kMuscles> kArm26{{{798.52, 0.1340, 0.1430, 0.20943951},
                                                              {624.30, 0.1138, 0.0980, 0.15707963},
                                                              {624.30, 0.1138, 0.0908, 0.15707963},
                                                              {624.30, 0.1157, 0.2723, 0.0},
                                                              {435.56, 0.1321, 0.1923, 0.0},
                                                              {987.26, 0.0858, 0.0535, 0.0}}};
const ThelenCurves kThelen{0.033, 0.6, 0.5, 4.0, 0.3, 1.8, 0.95};

std::vector<MuscleParameters> arm(const MuscleCurves& curves, bool rigid) {
  std::vector<MuscleParameters> muscles;
  for (const auto& [F0, L0, LS, phi0] : kArm26) {
    MuscleParameters p;
    p.name = std::to_string(muscles.size());
    p.musculotendon = {F0, L0, LS, phi0, 10.0, 0.01, 0.04};
    p.curves = curves;
    p.fiber_damping = std::holds_alternative<MillardCurves>(curves) ? 0.1 : 0.0;
    p.rigid_tendon = rigid;
    muscles.push_back(p);
  }
  return muscles;
}

// Fibres near equilibrium, as in a simulation: the tendon's strain is off by up to a thousandth. Along a motion each
// muscle's state changes little from one call to the next, as an integrator asks; else every call is another state.
template <typename Scalar>
struct States {
  explicit States(const MuscleGroup<double>& group, bool motion = true) {
    std::mt19937_64 generator(3);
    std::uniform_real_distribution<double> random(0.0, 1.0);
    std::vector<double> a(kMuscles), lMT(kMuscles), lM(kMuscles);
    for (std::size_t s = 0; s < kStates; ++s) {
      const auto uniform = [&](std::size_t i, double phase) {
        if (!motion) return random(generator);
        return 0.5 +
               0.5 * std::sin(2.0 * kPi * (static_cast<double>(s) / kStates + 0.13 * static_cast<double>(i) + phase));
      };
      for (std::size_t i = 0; i < kMuscles; ++i) {
        a[i] = 0.02 + 0.9 * uniform(i, 0.0);
        lMT[i] = kArm26[i][2] + kArm26[i][1] * (0.7 + 0.5 * uniform(i, 0.37));
      }
      group.equilibrium(a, lMT, lM);
      for (std::size_t i = 0; i < kMuscles; ++i) {
        u.emplace_back(uniform(i, 0.1));
        activation.emplace_back(a[i]);
        path.emplace_back(lMT[i]);
        speed.emplace_back(0.2 * (uniform(i, 0.2) - 0.5));
        fiber.emplace_back(lM[i] + 2e-3 * kArm26[i][2] * (uniform(i, 0.6) - 0.5));
      }
    }
  }
  [[nodiscard]] MuscleInputs<Scalar> at(std::size_t s) const {
    const auto part = [&](const std::vector<Scalar>& v) { return std::span(v).subspan(s * kMuscles, kMuscles); };
    return {part(u), part(activation), part(fiber), part(path), part(speed)};
  }
  std::vector<Scalar> u, activation, path, speed, fiber;
};

template <typename Scalar>
void run_rates(benchmark::State& state, const MuscleCurves& curves, bool rigid = false, bool motion = true) {
  const std::vector<MuscleParameters> parameters = arm(curves, rigid);
  const MuscleGroup<double> plain(parameters);
  const MuscleGroup<Scalar> group(parameters);
  const States<Scalar> states(plain, motion);
  std::array<Scalar, kMuscles> rate, velocity, force;
  std::size_t s = 0;
  for (auto _ : state) {
    group.rates(states.at(s), {rate, velocity, force});
    benchmark::DoNotOptimize(velocity.data());
    benchmark::DoNotOptimize(force.data());
    benchmark::ClobberMemory();
    s = (s + 1) % kStates;
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(kMuscles));
}

void forces(benchmark::State& state, const MuscleCurves& curves) {
  const MuscleGroup<double> group(arm(curves, false));
  const States<double> states(group);
  std::array<double, kMuscles> force;
  std::size_t s = 0;
  for (auto _ : state) {
    group.tendon_forces(states.at(s), force);
    benchmark::DoNotOptimize(force.data());
    benchmark::ClobberMemory();
    s = (s + 1) % kStates;
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(kMuscles));
}

void equilibrium(benchmark::State& state, const MuscleCurves& curves) {
  const MuscleGroup<double> group(arm(curves, false));
  const States<double> states(group);
  std::array<double, kMuscles> fiber;
  std::size_t s = 0;
  for (auto _ : state) {
    group.equilibrium(states.at(s).activation, states.at(s).path_length, fiber);
    benchmark::DoNotOptimize(fiber.data());
    benchmark::ClobberMemory();
    s = (s + 1) % kStates;
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(kMuscles));
}

void rates(benchmark::State& state, const MuscleCurves& curves, bool rigid = false) {
  run_rates<double>(state, curves, rigid);
}
void rates_at_random(benchmark::State& state, const MuscleCurves& curves) {
  run_rates<double>(state, curves, false, false);
}
void rates_with_derivatives(benchmark::State& state, const MuscleCurves& curves) {
  run_rates<ceres::Jet<double, 8>>(state, curves);
}
BENCHMARK_CAPTURE(rates, thelen, kThelen);
BENCHMARK_CAPTURE(rates, thelen_deprecated, DeprecatedThelenCurves{});
BENCHMARK_CAPTURE(rates, millard, MillardCurves{});
BENCHMARK_CAPTURE(rates, degroote, DeGrooteFregly2016Curves{});
BENCHMARK_CAPTURE(rates, thelen_rigid, kThelen, true);
BENCHMARK_CAPTURE(rates, millard_rigid, MillardCurves{}, true);
BENCHMARK_CAPTURE(rates_at_random, thelen, kThelen);
BENCHMARK_CAPTURE(rates_at_random, millard, MillardCurves{});
BENCHMARK_CAPTURE(rates_with_derivatives, thelen_eight, kThelen);
BENCHMARK_CAPTURE(rates_with_derivatives, millard_eight, MillardCurves{});
BENCHMARK_CAPTURE(forces, thelen, kThelen);
BENCHMARK_CAPTURE(forces, millard, MillardCurves{});
BENCHMARK_CAPTURE(equilibrium, thelen, kThelen);
BENCHMARK_CAPTURE(equilibrium, millard, MillardCurves{});
BENCHMARK_CAPTURE(equilibrium, degroote, DeGrooteFregly2016Curves{});

// One frame of arm26: six muscles, two coordinates with reserves, each frame from the last one.
void static_optimization(benchmark::State& state, double exponent, StaticForce force) {
  std::vector<MuscleParameters> muscles = arm(kThelen, false);
  StaticOptimizer optimizer(muscles, {.exponent = exponent, .force = force, .reserve = {1.0, 1.0}});
  Eigen::MatrixXd arms(6, 2);
  arms << -0.02, -0.025, 0.0, -0.025, 0.0, -0.025, 0.03, 0.03, 0.025, 0.035, 0.0, 0.02;
  Eigen::VectorXd length(6), speed(6), required(2);
  StaticOptimizationFrame frame;
  std::size_t s = 0;
  for (auto _ : state) {
    const double phase = 2.0 * kPi * static_cast<double>(s) / 200.0;
    for (Eigen::Index i = 0; i < 6; ++i) {
      const auto& [F0, L0, LS, phi0] = kArm26[static_cast<std::size_t>(i)];
      length(i) = LS + L0 * (1.0 + 0.15 * std::sin(phase + 0.7 * static_cast<double>(i)));
      speed(i) = 0.1 * std::cos(phase + 0.7 * static_cast<double>(i));
    }
    required << 2.0 + 2.0 * std::sin(phase), 1.5 + 2.0 * std::cos(phase);
    optimizer.solve(arms, length, speed, required, frame);
    benchmark::DoNotOptimize(frame.activation.data());
    s = (s + 1) % 200;
  }
}
BENCHMARK_CAPTURE(static_optimization, squares_as_opensim, 2.0, StaticForce::kAsOpenSim);
BENCHMARK_CAPTURE(static_optimization, cubes_as_opensim, 3.0, StaticForce::kAsOpenSim);
BENCHMARK_CAPTURE(static_optimization, squares_with_passive, 2.0, StaticForce::kWithPassive);

void bezier_value(benchmark::State& state) {
  const Millard2012 m;
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> uniform(0.5, 1.7);
  std::vector<double> x(1024);
  for (double& v : x) v = uniform(generator);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(m.active_length(x[i]));
    i = (i + 1) % x.size();
  }
}
BENCHMARK(bezier_value);

void bezier_exact(benchmark::State& state) {
  const Millard2012 m;
  double x = 0.5;
  for (auto _ : state) {
    benchmark::DoNotOptimize(m.active_curve().exact(x));
    x = x > 1.7 ? 0.5 : x + 0.00137;
  }
}
BENCHMARK(bezier_exact);

void compile_millard(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(Millard2012().min_length());
}
BENCHMARK(compile_millard)->Unit(benchmark::kMicrosecond);

}  // namespace
