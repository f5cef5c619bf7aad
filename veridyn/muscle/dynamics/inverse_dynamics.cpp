#include "veridyn/muscle/dynamics/inverse_dynamics.hpp"

#include "veridyn/core/assert.hpp"
#include "veridyn/muscle/dynamics/dynamics.hpp"

namespace veridyn::muscle {

CoordinateTable inverse_dynamics(const Mechanism& mechanism, const CoordinateTable& q, const CoordinateTable& qdot,
                                 const CoordinateTable& qddot) {
  VERIDYN_ASSERT(q.cols() == mechanism.coordinates());
  VERIDYN_ASSERT(qdot.rows() == q.rows() && qdot.cols() == q.cols());
  VERIDYN_ASSERT(qddot.rows() == q.rows() && qddot.cols() == q.cols());
  Dynamics<double> dynamics(mechanism);
  CoordinateTable tau(q.rows(), q.cols());
  for (Eigen::Index row = 0; row < q.rows(); ++row) {
    dynamics.set_state(q.row(row).data(), qdot.row(row).data());
    dynamics.inverse_dynamics(qddot.row(row).data(), nullptr, tau.row(row).data());
  }
  return tau;
}

Eigen::VectorXd inverse_dynamics(const Mechanism& mechanism, const Eigen::VectorXd& q, const Eigen::VectorXd& qdot,
                                 const Eigen::VectorXd& qddot) {
  return inverse_dynamics(mechanism, CoordinateTable(q.transpose()), CoordinateTable(qdot.transpose()),
                          CoordinateTable(qddot.transpose()))
      .transpose();
}

}  // namespace veridyn::muscle
