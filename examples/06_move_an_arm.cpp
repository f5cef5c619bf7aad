// The built-in arm, told to bend its elbow: a musculoskeletal model in twenty lines. A model of your own:
// load_model("my.osim").
#include <cstdio>
#include <numbers>
#include <vector>

#include "picture.hpp"
#include "veridyn/muscle.hpp"

int main() {
  using namespace veridyn::muscle;
  const MusculoskeletalSystem arm(load_model("arm").model());

  StartState start = default_start(arm.model());
  std::vector<double> excitation(arm.muscles().size(), 0.02);
  const int brachialis = arm.model().muscle("brachialis");
  excitation[static_cast<std::size_t>(brachialis)] = 0.10;

  veridyn::Progress silent;
  const MuscleTrajectory motion = simulate_forward(arm, start, {ControlSignals(excitation), {}}, {.end = 0.5}, silent);
  if (!motion.usable()) {
    std::fprintf(stderr, "%s\n", motion.message().c_str());
    return 1;
  }
  const int elbow = arm.model().coordinate("elbow_flexion");
  const auto degrees = [&](Eigen::Index row) { return motion.q(row, elbow) * 180.0 / std::numbers::pi; };
  const int triceps = arm.model().muscle("triceps_long");
  std::vector<double> angle, brachialis_force, triceps_force;
  for (Eigen::Index row = 0; row < motion.q.rows(); ++row) {
    angle.push_back(degrees(row));
    brachialis_force.push_back(motion.tendon_force(row, brachialis));
    triceps_force.push_back(motion.tendon_force(row, triceps));
  }
  picture::write("06_move_an_arm.csv", {{"time[s]", motion.time},
                                        {"elbow[deg]", angle},
                                        {"brachialis[N]", brachialis_force},
                                        {"triceps[N]", triceps_force}});
  std::printf("elbow from %.1f to %.1f deg in %ld steps of the integrator\n", degrees(0), degrees(motion.q.rows() - 1),
              motion.steps);
  return degrees(motion.q.rows() - 1) > degrees(0) ? 0 : 1;
}
