// Kinematics and dynamics of an arm (2 coordinates, 2 links) and of a walker's tree (23 coordinates, 12 links), step by
// step, with derivatives, and alongside Simbody's accelerations of the same trees.
#include <benchmark/benchmark.h>
#include <ceres/jet.h>

#include "tests/muscle/dynamics/model_trees.hpp"
#include "veridyn/muscle/dynamics/dynamics.hpp"
#include "veridyn/muscle/dynamics/reduced_dynamics.hpp"
#ifdef VERIDYN_HAS_SIMBODY
#include "tests/support/simbody/simbody_description.hpp"
#endif

namespace {
using namespace veridyn::muscle;

template <typename Scalar>
struct Case {
  Mechanism mechanism;
  Dynamics<Scalar> dynamics;
  Eigen::Matrix<Scalar, Eigen::Dynamic, 1> q, qdot, tau, result;

  explicit Case(const Model& model)
      : mechanism(model),
        dynamics(mechanism),
        q(mechanism.coordinates()),
        qdot(mechanism.coordinates()),
        tau(mechanism.coordinates()),
        result(mechanism.coordinates()) {
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      q(i) = Scalar(0.3 + 0.05 * static_cast<double>(i % 5));
      qdot(i) = Scalar(1.0 - 0.1 * static_cast<double>(i % 7));
      tau(i) = Scalar(0.5);
    }
    dynamics.set_state(q.data(), qdot.data());
  }
};

void kinematics(benchmark::State& state, const Model& model) {
  Case<double> c(model);
  Kinematics<double> k(c.mechanism);
  for (auto _ : state) {
    update_positions(c.mechanism, c.q.data(), k);
    update_velocities(c.mechanism, c.qdot.data(), k);
    benchmark::DoNotOptimize(k.velocity.data());
    benchmark::ClobberMemory();
  }
}

void set_state(benchmark::State& state, const Model& model) {
  Case<double> c(model);
  for (auto _ : state) {
    c.dynamics.set_state(c.q.data(), c.qdot.data());
    benchmark::ClobberMemory();
  }
}

void newton_euler(benchmark::State& state, const Model& model) {
  Case<double> c(model);
  for (auto _ : state) {
    c.dynamics.inverse_dynamics(c.tau.data(), nullptr, c.result.data());
    benchmark::ClobberMemory();
  }
}

void composite_bodies(benchmark::State& state, const Model& model) {
  Case<double> c(model);
  for (auto _ : state) {
    c.dynamics.update_mass_rows();
    benchmark::ClobberMemory();
  }
}

template <typename Scalar, bool kArticulated>
void forward(benchmark::State& state, const Model& model) {
  Case<Scalar> c(model);
  for (auto _ : state) {
    c.dynamics.set_state(c.q.data(), c.qdot.data());
    if constexpr (kArticulated) {
      benchmark::DoNotOptimize(
          c.dynamics.forward_dynamics_articulated(c.tau.data(), nullptr, c.result.data()).singular_coordinate);
    } else {
      benchmark::DoNotOptimize(
          c.dynamics.forward_dynamics_factorized(c.tau.data(), nullptr, c.result.data()).singular_coordinate);
    }
    benchmark::ClobberMemory();
  }
}

// As the published tasks have it: the first coordinate (of the arm: the shoulder) is locked.
void forward_with_lock(benchmark::State& state, const Model& model) {
  Model locked = model;
  locked.coordinates[0].locked = true;
  Case<double> c(locked);
  const CoordinateReduction reduction(locked);
  ReducedDynamics<double> dynamics(c.mechanism, reduction);
  const std::vector<DrivenMotion<double>> driven = reduction.default_motion();
  for (auto _ : state) {
    dynamics.set_state(c.q.data(), c.qdot.data(), driven.data());
    benchmark::DoNotOptimize(dynamics.forward_dynamics(c.tau.data(), nullptr, c.result.data()).singular_coordinate);
    benchmark::ClobberMemory();
  }
}

#ifdef VERIDYN_HAS_SIMBODY
void simbody(benchmark::State& state, const Model& model) {
  test::SimbodyTree tree(test::describe(model));
  const Case<double> c(model);
  tree.set_state(c.q, c.qdot);
  for (auto _ : state) tree.realize_accelerations();
}
#endif

const Model& arm() {
  static const Model kModel = test::arm26_skeleton();
  return kModel;
}
const Model& walker() {
  static const Model kModel = test::gait_like();
  return kModel;
}

const int kRegistered = [] {
  using Jet = ceres::Jet<double, 4>;
  for (const bool is_arm : {true, false}) {
    const Model& model = is_arm ? arm() : walker();
    const std::string name = is_arm ? "arm/" : "walker/";
    const auto add = [&](const char* what, void (*run)(benchmark::State&, const Model&)) {
      benchmark::RegisterBenchmark((name + what).c_str(),
                                   [run, &model](benchmark::State& state) { run(state, model); });
    };
    add("kinematics", kinematics);
    add("set_state", set_state);
    add("newton_euler_inverse_dynamics", newton_euler);
    add("composite_bodies_mass_matrix", composite_bodies);
    add("forward_dynamics_factorized", forward<double, false>);
    add("forward_dynamics_articulated", forward<double, true>);
    add("forward_dynamics_one_coordinate_locked", forward_with_lock);
    add("forward_dynamics_factorized_4_derivatives", forward<Jet, false>);
    add("forward_dynamics_articulated_4_derivatives", forward<Jet, true>);
#ifdef VERIDYN_HAS_SIMBODY
    add("simbody_realize_acceleration", simbody);
#endif
  }
  return 0;
}();

}  // namespace
