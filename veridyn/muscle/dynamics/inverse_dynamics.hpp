#pragma once

#include <Eigen/Core>

#include "veridyn/muscle/dynamics/mechanism.hpp"

namespace veridyn::muscle {

/// One row a sample, one column a coordinate.
using CoordinateTable = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Generalised forces [N m or N] that a recorded motion needs, M(q) qddot + h(q, qdot), of gravity and inertia alone.
///
/// As OpenSim's inverse dynamics: constraints are ignored, coupled and locked coordinates are treated as free, and no
/// force of the model acts. Coordinates of free and ball joints are angles here, angular velocities in OpenSim (see
/// `Joint`). The tables have the same shape, with as many columns as the mechanism has coordinates.
[[nodiscard]] CoordinateTable inverse_dynamics(const Mechanism& mechanism, const CoordinateTable& q,
                                               const CoordinateTable& qdot, const CoordinateTable& qddot);

/// The same of one sample.
[[nodiscard]] Eigen::VectorXd inverse_dynamics(const Mechanism& mechanism, const Eigen::VectorXd& q,
                                               const Eigen::VectorXd& qdot, const Eigen::VectorXd& qddot);

}  // namespace veridyn::muscle
