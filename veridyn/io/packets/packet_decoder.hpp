#pragma once

#include <Eigen/Geometry>
#include <array>
#include <span>
#include <string_view>

#include "veridyn/io/packets/packet_layout.hpp"

namespace veridyn::io {

/// What a packet says of the motion of the body, frame flu; NaN where it does not say. The world has z up.
struct PacketMotion {
  double time = 0.0;             ///< the sender's [s]
  Eigen::Vector3d position;      ///< world [m]
  Eigen::Vector3d velocity;      ///< world [m/s]
  Eigen::Vector3d acceleration;  ///< body [m/s^2]; of the world's turned into the body where the attitude is known
  Eigen::Vector3d rate;          ///< body [rad/s]
  Eigen::Quaterniond attitude;   ///< body to world
  double speed = 0.0;            ///< forward [m/s]
};

/// Turns packets of one layout into numbers, one by one or live: nothing allocates or throws after construction.
class PacketDecoder {
 public:
  /// @throws InputError as `check`
  explicit PacketDecoder(PacketLayout layout);

  [[nodiscard]] const PacketLayout& layout() const { return layout_; }
  /// The fields in their units, in the order of the layout's.
  /// @param values as many as there are fields
  /// @return whether the packet has the layout's size and start; otherwise values are as they were
  bool decode(std::string_view packet, std::span<double> values) const;
  /// The motion that decoded values say.
  [[nodiscard]] PacketMotion motion(std::span<const double> values) const;
  /// Whether values are such as a drive has: finite, times, speeds and places within reason, axes at right angles,
  /// speed as long as the velocity. All zero, as in menus, is none.
  [[nodiscard]] bool is_plausible(std::span<const double> values) const;

 private:
  enum Quantity : std::size_t {
    kTime,
    kSpeed,
    kPosition,
    kVelocity = kPosition + 3,
    kWorldVelocity = kVelocity + 3,
    kAcceleration = kWorldVelocity + 3,
    kWorldAcceleration = kAcceleration + 3,
    kRate = kWorldAcceleration + 3,
    kForward = kRate + 3,
    kRight = kForward + 3,
    kAngles = kRight + 3,
    kQuantities = kAngles + 3,
  };
  [[nodiscard]] double at(std::span<const double> values, std::size_t quantity) const;
  [[nodiscard]] Eigen::Vector3d vector_at(std::span<const double> values, std::size_t quantity) const;

  PacketLayout layout_;
  std::array<std::size_t, kQuantities> places_{};  ///< in the layout's fields; their number where it has none
};

}  // namespace veridyn::io
