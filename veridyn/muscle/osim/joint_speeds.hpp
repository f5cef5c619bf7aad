#pragma once

#include <Eigen/Core>

#include "veridyn/muscle/model/model.hpp"

/// Speeds of coordinates as OpenSim counts them, for what crosses between it and us. Of ball, free and ellipsoid joints
/// (the scapulothoracic one rolls on such) OpenSim's three speeds are the angular velocity of the child's frame in the
/// parent's, in axes of the parent's, whereas coordinates are the angles a of a body-fixed x-y-z sequence:
///
///     w = x a0' + Rx(a0) y a1' + Rx(a0) Ry(a1) z a2'
///
/// Speeds of all other coordinates, translations of free joints among them, are the coordinates' rates.
namespace veridyn::muscle {

/// OpenSim's speeds, by coordinate, for rates at the pose q.
[[nodiscard]] Eigen::VectorXd opensim_speeds(const Model& model, const Eigen::VectorXd& q,
                                             const Eigen::VectorXd& rates);

/// Rates of the coordinates for OpenSim's speeds at the pose q.
/// @throws InputError naming a joint whose second angle is +-90 deg, where no rates give an angular velocity.
[[nodiscard]] Eigen::VectorXd rates_of_opensim_speeds(const Model& model, const Eigen::VectorXd& q,
                                                      const Eigen::VectorXd& speeds);

}  // namespace veridyn::muscle
