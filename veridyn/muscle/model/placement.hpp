#pragma once

#include <Eigen/Core>

namespace veridyn::muscle {

/// Where frame C stands in frame P: x_P = rotation x_C + translation.
struct Placement {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  [[nodiscard]] Placement operator*(const Placement& inner) const {
    return {rotation * inner.rotation, rotation * inner.translation + translation};
  }
  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return rotation * point + translation; }
  [[nodiscard]] Placement inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }
};

/// Body-fixed x-y-z rotation sequence, R = Rx(a) Ry(b) Rz(c): OpenSim's `orientation` and `xyz_body_rotation`.
[[nodiscard]] Eigen::Matrix3d body_fixed_xyz(const Eigen::Vector3d& angles);

}  // namespace veridyn::muscle
