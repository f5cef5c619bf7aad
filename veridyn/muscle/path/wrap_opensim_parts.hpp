#pragma once

#include <algorithm>
#include <cmath>

#include "veridyn/muscle/path/wrap_opensim.hpp"

/// What the sources of `wrap_as_opensim` share.
namespace veridyn::muscle::internal {

inline double sign_of(double x) { return x >= 0.0 ? 1.0 : -1.0; }
inline double angle_between(const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
  return std::acos(std::clamp(u.dot(v) / (u.norm() * v.norm()), -1.0, 1.0));
}

[[nodiscard]] OpenSimWrap wrap_cylinder_as_opensim(const WrapObject& object, bool only_wrap_of_path,
                                                   const Eigen::Vector3d& p, const Eigen::Vector3d& q);

}  // namespace veridyn::muscle::internal
