#include "veridyn/live/virtual/motion_packet.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string_view>
#include <vector>

#include "veridyn/io/packets/known_packets.hpp"
#include "veridyn/io/packets/packet_decoder.hpp"

namespace veridyn::live {
namespace {

TEST(MotionPacket, IsReadAsItWasWritten) {
  PacketedMotion m;
  m.sequence = 0xfffffffeU;
  m.time = 1234.567891;
  m.position = {10.5, -200.25, 3.0};
  m.velocity = {-4.0, 12.5, 0.75};
  m.force = {1.5, -2.5, 9.75};
  m.rate = {0.125, -0.25, 0.5};
  m.attitude = Eigen::AngleAxisd(2.5, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(-0.3, Eigen::Vector3d::UnitY()) *
               Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX());
  std::array<char, kMotionPacketBytes> packet{};
  encode_motion(m, packet);
  const io::PacketDecoder decoder(io::known_packet("veridyn"));
  std::vector<double> values(decoder.layout().fields.size());
  ASSERT_TRUE(decoder.decode({packet.data(), packet.size()}, values));
  ASSERT_TRUE(decoder.is_plausible(values));
  EXPECT_EQ(values[decoder.layout().find("sequence")], 4294967294.0);
  const io::PacketMotion read = decoder.motion(values);
  EXPECT_EQ(read.time, m.time);
  // Numbers of single precision, which these are.
  EXPECT_EQ(read.position, m.position);
  EXPECT_EQ(read.velocity, m.velocity);
  EXPECT_EQ(read.acceleration, m.force);
  EXPECT_EQ(read.rate, m.rate);
  EXPECT_LT(read.attitude.angularDistance(m.attitude), 1e-6);
}

}  // namespace
}  // namespace veridyn::live
