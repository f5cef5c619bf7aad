#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "veridyn/live/time/clock.hpp"

namespace veridyn::live {

/// Where a camera above the track saw the car in one frame.
struct CameraPose {
  std::uint32_t sequence = 0;                            ///< one more from frame to frame, unseen ones included
  Nanoseconds stamp = 0;                                 ///< middle of the exposure, by the camera's clock
  Eigen::Vector3d pose = Eigen::Vector3d::Zero();        ///< x, y [m], heading [rad]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of these
};

/// Bytes of such a packet.
inline constexpr std::size_t kPosePacketBytes = 92;
using PosePacket = std::array<char, kPosePacketBytes>;

/// Little-endian: `VCP1` | sequence u32 | stamp i64 [ns] | pose 3 f64 | covariance 6 f64: xx, xy, xh, yy, yh, hh |
/// CRC-32 of all before.
[[nodiscard]] PosePacket encode(const CameraPose& pose);
/// Nothing where size, start or CRC are wrong, a number is not finite, or the covariance not positive definite.
[[nodiscard]] std::optional<CameraPose> decode_pose(std::string_view bytes);

}  // namespace veridyn::live
