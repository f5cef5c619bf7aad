#pragma once

#include <Eigen/Geometry>

namespace veridyn::recording {

/// By how much a point of a rigid body accelerates more than its centre of gravity, w' x r + w x (w x r).
/// @param rate w, and its derivative w' [rad/s, rad/s^2]
/// @param position r of the point from the centre of gravity [m]; all in axes of the body
[[nodiscard]] inline Eigen::Vector3d lever_arm_acceleration(const Eigen::Vector3d& rate_derivative,
                                                            const Eigen::Vector3d& rate,
                                                            const Eigen::Vector3d& position) {
  return rate_derivative.cross(position) + rate.cross(rate.cross(position));
}

}  // namespace veridyn::recording
