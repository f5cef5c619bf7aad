// The built-in arm, told to bend its elbow: a musculoskeletal model in twenty lines. A model of your own:
// load_model("my.osim").
#include <cstdio>
#include <numbers>

#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"

int main() {
  using namespace veridyn::muscle;
  const MusculoskeletalSystem arm(load_model("arm").model());

  StartState start = default_start(arm.model());
  std::vector<double> excitation(arm.muscles().size(), 0.02);
  excitation[static_cast<std::size_t>(arm.model().muscle("brachialis"))] = 0.10;

  veridyn::Progress silent;
  const MuscleTrajectory motion = simulate_forward(arm, start, {ControlSignals(excitation), {}}, {.end = 0.5}, silent);
  if (!motion.usable()) {
    std::fprintf(stderr, "%s\n", motion.message().c_str());
    return 1;
  }
  const int elbow = arm.model().coordinate("elbow_flexion");
  const auto degrees = [&](Eigen::Index row) { return motion.q(row, elbow) * 180.0 / std::numbers::pi; };
  std::printf("elbow from %.1f to %.1f deg in %ld steps of the integrator\n", degrees(0), degrees(motion.q.rows() - 1),
              motion.steps);
  return degrees(motion.q.rows() - 1) > degrees(0) ? 0 : 1;
}
