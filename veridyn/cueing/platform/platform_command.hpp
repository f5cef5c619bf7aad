#pragma once

#include <Eigen/Core>

namespace veridyn::cueing {

/// Where a platform is to be against its neutral position, and how it is to move there. Platform axes: surge forward,
/// sway to the right, heave up [m]; roll right side down, pitch nose up, yaw nose right [rad], turned in the order yaw,
/// pitch, roll.
struct PlatformCommand {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();         ///< surge, sway, heave [m]
  Eigen::Vector3d angle = Eigen::Vector3d::Zero();         ///< roll, pitch, yaw [rad]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< of the shift [m/s^2]
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();          ///< of the angle, at small angles [rad/s]
};

/// A vector along forward, right, down in platform axes, or back; rotations keep their sign.
[[nodiscard]] inline Eigen::Vector3d shift_from_frd(const Eigen::Vector3d& frd) { return {frd.x(), frd.y(), -frd.z()}; }

}  // namespace veridyn::cueing
