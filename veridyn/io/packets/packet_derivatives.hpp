#pragma once

#include <bitset>
#include <cstddef>
#include <span>

#include "veridyn/io/packets/packet_decoder.hpp"

namespace veridyn::io {

/// How far about a packet others are taken for its derivatives [s]. Stamps jitter by as much as they are apart: a
/// tenth of a second in all evens that out.
struct DerivativeWindow {
  double before = 0.05;
  double after = 0.05;  ///< 0 of packets that have only just come in: a derivative is then `before` / 2 late
};

/// What of a packet's motion was derived.
struct DerivedMotion {
  PacketMotion motion;
  std::bitset<3> acceleration;  ///< by axis
  bool rate = false;
};

/// The motion of packet k; accelerations and rates that it does not say are derived from velocity and attitude by
/// lines of least squares over the packets in the window. NaN stays where attitude or velocity are not known either,
/// zero comes out where there is no other packet. Nothing is allocated or thrown.
/// @param motions in the order of their stamps
[[nodiscard]] DerivedMotion with_derivatives(std::span<const PacketMotion> motions, std::size_t k,
                                             const DerivativeWindow& window = {});

/// The change of the angular rate about packet k [rad/s^2], in body axes; by lines as above.
[[nodiscard]] Eigen::Vector3d angular_acceleration(std::span<const PacketMotion> motions, std::size_t k,
                                                   const DerivativeWindow& window = {});

/// Whether one packet can follow another in a drive: a little later, and about where the velocity leads.
[[nodiscard]] bool follows(const PacketMotion& before, const PacketMotion& after);

}  // namespace veridyn::io
