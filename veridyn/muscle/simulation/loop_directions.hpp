#pragma once

#include <Eigen/Core>

#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/muscle/dynamics/reduced_dynamics.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {

/// View of a system, which must outlive it: the motions of its free coordinates that its closed loops allow, at one
/// pose after another.
class LoopDirections {
 public:
  explicit LoopDirections(const MusculoskeletalSystem& system);

  /// Whether the system has loops; without them nothing below may be called.
  [[nodiscard]] bool any() const { return jacobian_.rows() > 0; }

  /// Looks at the loops of the state set in `dynamics`, which is of the same system; returns them with their errors.
  LoopSolver<double>& set_pose(ReducedDynamics<double>& dynamics);

  /// A: rates of the loops' errors for unit speeds of the free coordinates.
  [[nodiscard]] const estimation::RowMatrix& jacobian() const { return jacobian_; }
  /// N, orthonormal, by free coordinate: A N = 0.
  [[nodiscard]] const Eigen::MatrixXd& directions() const { return directions_; }

  /// After `Dynamics::inverse_dynamics` of accelerations at the state: the least change of the free ones with which the
  /// loops' errors have no second derivative.
  [[nodiscard]] Eigen::VectorXd acceleration_shortfall(ReducedDynamics<double>& dynamics);

  /// Multipliers lambda, kept by `loops`, with the least sum of squares of forces - A' lambda.
  void carry(const Eigen::VectorXd& forces, LoopSolver<double>& loops) const;

 private:
  estimation::RowMatrix jacobian_;
  Eigen::MatrixXd directions_;
};

}  // namespace veridyn::muscle
