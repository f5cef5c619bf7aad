#pragma once

#include <Eigen/Core>
#include <array>

#include "veridyn/cueing/perception/vestibular_model.hpp"
#include "veridyn/numerics/linear_systems/causal_filter.hpp"

namespace veridyn::cueing {

/// What a person feels of a motion: the model's canals and otoliths, fed sample by sample at any step. Between samples
/// motion is taken to go on a line. Nothing is allocated or thrown after construction; a copy saves the state.
class Perception {
 public:
  /// What is felt at a moment.
  struct Felt {
    Eigen::Vector3d rate;   ///< roll, pitch, yaw [rad/s, or as the model's unit says]
    Eigen::Vector3d force;  ///< along x, y, z [m/s^2, or as the model's unit says]
  };

  explicit Perception(const VestibularModel& model);

  /// As if this motion had gone on for long.
  Felt reset(const Eigen::Vector3d& force, const Eigen::Vector3d& rate);
  /// @param force specific force at the head [m/s^2], head axes
  /// @param rate angular rate [rad/s], head axes
  /// @param step since the last sample [s]
  Felt step(const Eigen::Vector3d& force, const Eigen::Vector3d& rate, double step);

 private:
  std::array<numerics::CausalFilter, 3> canals_, otoliths_;
};

}  // namespace veridyn::cueing
