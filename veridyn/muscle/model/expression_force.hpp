#pragma once

#include <array>
#include <string>
#include <vector>

#include "veridyn/muscle/model/body_force.hpp"
#include "veridyn/muscle/model/expression.hpp"

/// Forces of a model that formulas give: `simulation/expression_forces.hpp` has their laws.
namespace veridyn::muscle {

/// On a coordinate, a formula of q and qdot (ExpressionBasedCoordinateForce) [N m or N].
struct ExpressionCoordinateForce {
  std::string name;
  int coordinate = 0;
  Expression force;
};

/// A pull between points of two bodies, a formula of their distance d and its rate ddot
/// (ExpressionBasedPointToPointForce) [N].
struct ExpressionPointForce {
  std::string name;
  int body_1 = 0, body_2 = 0;
  Eigen::Vector3d point_1 = Eigen::Vector3d::Zero(), point_2 = Eigen::Vector3d::Zero();  ///< in their bodies [m]
  Expression force;
};

/// A bushing whose resistance to each deflection is a formula of all of them, theta_x, theta_y, theta_z [rad], delta_x,
/// delta_y, delta_z [m] (ExpressionBasedBushingForce): moments, then forces. Its dampers are the bushing's.
struct ExpressionBushing {
  Bushing bushing;
  std::vector<Expression> resistance;  ///< six
};

/// All of a model.
struct ExpressionForces {
  std::vector<ExpressionCoordinateForce> coordinates;
  std::vector<ExpressionPointForce> points;
  std::vector<ExpressionBushing> bushings;

  [[nodiscard]] bool empty() const { return coordinates.empty() && points.empty() && bushings.empty(); }
};

}  // namespace veridyn::muscle
