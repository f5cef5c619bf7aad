#include "veridyn/live/virtual/motion_packet.hpp"

#include <array>

#include "veridyn/io/packets/known_packets.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::live {

void encode_motion(const PacketedMotion& m, std::span<char, kMotionPacketBytes> packet) {
  const auto angles = numerics::euler_from_quaternion(m.attitude);
  const std::array<double, 17> values = {static_cast<double>(m.sequence),
                                         m.time,
                                         m.position.x(),
                                         m.position.y(),
                                         m.position.z(),
                                         m.velocity.x(),
                                         m.velocity.y(),
                                         m.velocity.z(),
                                         m.force.x(),
                                         m.force.y(),
                                         m.force.z(),
                                         m.rate.x(),
                                         m.rate.y(),
                                         m.rate.z(),
                                         angles.phi,
                                         angles.theta,
                                         angles.psi};
  static const io::PacketLayout& layout = io::known_packet("veridyn");
  io::encode(layout, values, packet);
}

}  // namespace veridyn::live
