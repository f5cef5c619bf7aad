#include "veridyn/muscle/simulation/loop_directions.hpp"

#include "veridyn/core/index.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"

namespace veridyn::muscle {

LoopDirections::LoopDirections(const MusculoskeletalSystem& system)
    : jacobian_(system.loops().rows(), signed_index(system.reduction().free().size())) {}

LoopSolver<double>& LoopDirections::set_pose(ReducedDynamics<double>& dynamics) {
  LoopSolver<double>& loops = dynamics.update_loops();
  const Eigen::Index n = jacobian_.cols();
  for (int r = 0; r < loops.rows(); ++r) jacobian_.row(r) = Eigen::Map<const Eigen::RowVectorXd>(loops.jacobian(r), n);
  const numerics::Eliminated basis =
      numerics::eliminate(jacobian_.transpose(), Eigen::MatrixXd::Identity(n, n), LoopSolver<double>::kRounding);
  directions_ = basis.rest.bottomRows(n - basis.rank).transpose();
  return loops;
}

Eigen::VectorXd LoopDirections::acceleration_shortfall(ReducedDynamics<double>& dynamics) {
  LoopSolver<double>& loops = dynamics.update_loops();
  Eigen::VectorXd wanted(jacobian_.rows());
  for (int r = 0; r < loops.rows(); ++r) {
    const LoopConstraints::Constraint& constraint = loops.loops().of_row(r);
    const SpatialVector<double>&one = dynamics.dynamics().acceleration(constraint.link_1),
          &two = dynamics.dynamics().acceleration(constraint.link_2);
    const SpatialVector<double> relative{two.angular - one.angular, two.linear - one.linear};
    wanted(r) = -(loops.row(r).rate_bias + loops.row(r).force.dot(relative));
  }
  loops.solve(jacobian_.data(), wanted.data());
  Eigen::VectorXd change = Eigen::VectorXd::Zero(jacobian_.cols());
  for (int r = 0; r < loops.rows(); ++r) change += loops.multiplier(r) * jacobian_.row(r).transpose();
  return change;
}

void LoopDirections::carry(const Eigen::VectorXd& forces, LoopSolver<double>& loops) const {
  const Eigen::VectorXd wanted = jacobian_ * forces;
  loops.solve(jacobian_.data(), wanted.data());
}

}  // namespace veridyn::muscle
