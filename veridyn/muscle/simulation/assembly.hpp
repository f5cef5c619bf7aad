#pragma once

#include <Eigen/Core>
#include <string>

#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {

/// Pose and speeds at which the loops of a model are closed.
struct Assembly {
  Eigen::VectorXd q, qdot;  ///< all coordinates, coupled ones by their couplers
  double error = 0.0;       ///< largest left of an equation of a loop [m or 1]
  /// The coordinate that moved most, and by how much; -1: none.
  int moved = -1;
  double by = 0.0;
};

/// The pose and speeds nearest to the given ones that close all loops: Gauss-Newton steps of least change of the free
/// coordinates (rad and m alike), then the least change of their speeds. Locked coordinates stay. Without loops what
/// was given.
/// @throws InputError naming the constraint that is left open, and by how much, when no pose is found.
[[nodiscard]] Assembly assemble(const MusculoskeletalSystem& system, const Eigen::VectorXd& q,
                                const Eigen::VectorXd& qdot);

/// "to close the model's loops 'knee_angle' starts at 0.5 rad, 0.12 rad from the start given"; empty when nothing
/// moved.
[[nodiscard]] std::string assembly_text(const MusculoskeletalSystem& system, const Assembly& assembly);

}  // namespace veridyn::muscle
