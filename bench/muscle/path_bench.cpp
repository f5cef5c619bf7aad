// Musculotendon paths: exact lengths, with moment arms, and their polynomial fit.
//
// OpenSim 4.5.2 on a similar core (reference/opensim/e_timings_paths.csv), positions realised, per pose:
//   arm26 (6 muscles):          143 us lengths, 522 us with 9 moment arms
//   gait2392 (92 muscles):      133 us lengths, 19 013 us with 262 moment arms
// Poses change from call to call, through wraps that come and go. "per_path" is the time of one muscle.
#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include "tests/support/folders.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/path/muscle_path.hpp"
#include "veridyn/muscle/path/path_fit.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"

namespace {
using namespace veridyn::muscle;

struct Case {
  explicit Case(Model m) : model(std::move(m)), mechanism(model), paths(model, mechanism), workspace(paths) {
    // 64 poses over the middle of the ranges.
    for (int i = 0; i < 64; ++i) {
      Eigen::VectorXd q = model.default_pose();
      for (Eigen::Index c = 0; c < q.size(); ++c) {
        const Coordinate& k = model.coordinates[static_cast<std::size_t>(c)];
        if (k.high > k.low && k.high - k.low < 10.0)
          q[c] = k.low + (k.high - k.low) * (0.5 + 0.4 * std::sin(1.7 * i + 2.3 * static_cast<double>(c)));
      }
      poses.push_back(q);
      kinematics.emplace_back(mechanism);
      update_positions(mechanism, q.data(), kinematics.back());
    }
  }
  Model model;
  Mechanism mechanism;
  MusclePaths paths;
  PathWorkspace<double> workspace;
  std::vector<Eigen::VectorXd> poses;
  std::vector<Kinematics<double>> kinematics;
};

std::unique_ptr<Case> load(const std::string& name) {
  if (name == "arm") return std::make_unique<Case>(load_model("arm").model());
  const std::filesystem::path file = veridyn::test::shared_folder() / "data/opensim" / (name + ".osim");
  if (!std::filesystem::exists(file)) return nullptr;
  return std::make_unique<Case>(read_osim(file));
}

template <typename Work>
void over_poses(benchmark::State& state, const std::string& name, const Work& work) {
  const auto c = load(name);
  if (c == nullptr) {
    state.SkipWithError("the OpenSim models of ../shared/data are not here");
    return;
  }
  work(*c, state);
  state.counters["per_path"] =
      benchmark::Counter(static_cast<double>(c->paths.muscles()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void lengths(benchmark::State& state, const std::string& name) {
  over_poses(state, name, [](Case& c, benchmark::State& s) {
    std::size_t i = 0;
    for (auto _ : s) {
      i = (i + 1) % c.poses.size();
      c.paths.lengths(c.kinematics[i], c.poses[i].data(), c.workspace);
      benchmark::DoNotOptimize(c.workspace.length.data());
    }
  });
}

void lengths_and_moment_arms(benchmark::State& state, const std::string& name) {
  over_poses(state, name, [](Case& c, benchmark::State& s) {
    std::size_t i = 0;
    for (auto _ : s) {
      i = (i + 1) % c.poses.size();
      c.paths.evaluate(c.kinematics[i], c.poses[i].data(), c.workspace);
      benchmark::DoNotOptimize(c.workspace.gradient.data());
    }
  });
}

// arm26 where it works in the reference's simulations: shoulder -15..29 deg, elbow 0..130 deg.
void lengths_in_the_working_range(benchmark::State& state) {
  over_poses(state, "arm26", [](Case& c, benchmark::State& s) {
    for (std::size_t k = 0; k < c.poses.size(); ++k) {
      c.poses[k] << 0.12 + 0.38 * std::sin(1.7 * static_cast<double>(k)),
          1.1 + 1.1 * std::sin(0.9 * static_cast<double>(k));
      update_positions(c.mechanism, c.poses[k].data(), c.kinematics[k]);
    }
    std::size_t i = 0;
    for (auto _ : s) {
      i = (i + 1) % c.poses.size();
      if (s.range(0) == 0) {
        c.paths.lengths(c.kinematics[i], c.poses[i].data(), c.workspace);
      } else {
        c.paths.evaluate(c.kinematics[i], c.poses[i].data(), c.workspace);
      }
      benchmark::DoNotOptimize(c.workspace.gradient.data());
      benchmark::DoNotOptimize(c.workspace.length.data());
    }
  });
}
BENCHMARK(lengths_in_the_working_range)->Arg(0)->Arg(1)->ArgName("moment_arms");

void fitted(benchmark::State& state, const std::string& name) {
  over_poses(state, name, [](Case& c, benchmark::State& s) {
    const FittedPaths fit(c.model, c.mechanism, c.paths);
    std::vector<double> length(static_cast<std::size_t>(fit.muscles())), gradient(fit.pairs().size());
    std::size_t i = 0;
    for (auto _ : s) {
      i = (i + 1) % c.poses.size();
      fit.evaluate(c.poses[i].data(), length.data(), gradient.data());
      benchmark::DoNotOptimize(gradient.data());
    }
    double longest = 0.0, arm = 0.0, above = 0.0;
    for (const PathFitError& e : fit.errors()) {
      longest = std::max(longest, e.length);
      arm = std::max(arm, e.moment_arm);
      above = std::max(above, e.above_tolerance);
    }
    s.counters["length_error"] = longest;
    s.counters["arm_error"] = arm;
    s.counters["above_tolerance"] = above;
  });
}

BENCHMARK_CAPTURE(lengths, arm, std::string("arm"));
BENCHMARK_CAPTURE(lengths_and_moment_arms, arm, std::string("arm"));
BENCHMARK_CAPTURE(fitted, arm, std::string("arm"));
BENCHMARK_CAPTURE(lengths, arm26, std::string("arm26"));
BENCHMARK_CAPTURE(lengths_and_moment_arms, arm26, std::string("arm26"));
BENCHMARK_CAPTURE(fitted, arm26, std::string("arm26"));
BENCHMARK_CAPTURE(lengths, gait2392, std::string("gait2392_thelen2003muscle"));
BENCHMARK_CAPTURE(lengths_and_moment_arms, gait2392, std::string("gait2392_thelen2003muscle"));
BENCHMARK_CAPTURE(fitted, gait2392, std::string("gait2392_thelen2003muscle"))->Iterations(2000);

}  // namespace
