#pragma once

#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/path/muscle_path.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"

namespace veridyn::muscle::test {

/// A model, the built-in arm or another, and its exact paths at a pose.
struct PosedArm {
  explicit PosedArm(Model m, WrapMode mode = WrapMode::kTaut)
      : model(std::move(m)), mechanism(model), paths(model, mechanism, mode), workspace(paths), kinematics(mechanism) {}
  void pose(const Eigen::VectorXd& at) {
    q = at;
    update_positions(mechanism, q.data(), kinematics);
    paths.evaluate(kinematics, q.data(), workspace);
  }
  void pose_deg(double shoulder, double elbow) { pose(Eigen::Vector2d(shoulder * kDegree, elbow * kDegree)); }
  [[nodiscard]] double moment_arm(int muscle, int coordinate) const {
    for (std::size_t k = paths.first_pair(muscle); k < paths.end_pair(muscle); ++k)
      if (paths.pairs()[k].coordinate == coordinate) return -workspace.gradient[k];
    return 0.0;
  }
  Model model;
  Mechanism mechanism;
  MusclePaths paths;
  PathWorkspace<double> workspace;
  Kinematics<double> kinematics;
  Eigen::VectorXd q;
};

}  // namespace veridyn::muscle::test
