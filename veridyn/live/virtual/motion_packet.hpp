#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>

namespace veridyn::live {

/// What a packet `veridyn` says of a vehicle, frame flu; world with z up.
struct PacketedMotion {
  std::uint32_t sequence = 0;
  double time = 0.0;  ///< of the sender's clock [s]
  Eigen::Vector3d position = Eigen::Vector3d::Zero(), velocity = Eigen::Vector3d::Zero();  ///< world [m], [m/s]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();               ///< specific force, gravity in [m/s^2]
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();                ///< [rad/s]
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();  ///< body to world
};

/// Bytes of such a packet.
inline constexpr std::size_t kMotionPacketBytes = 76;

/// Writes it, see docs/formats.md.
void encode_motion(const PacketedMotion& motion, std::span<char, kMotionPacketBytes> packet);

}  // namespace veridyn::live
