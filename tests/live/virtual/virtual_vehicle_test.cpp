#include "veridyn/live/virtual/virtual_vehicle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "tests/live/weaving_drive.hpp"
#include "veridyn/io/packets/known_packets.hpp"
#include "veridyn/io/packets/packet_decoder.hpp"

namespace veridyn::live {
namespace {

io::PacketMotion decoded_motion(std::string_view packet) {
  static const io::PacketDecoder decoder(io::known_packet("veridyn"));
  std::vector<double> values(decoder.layout().fields.size());
  EXPECT_TRUE(decoder.decode(packet, values));
  return decoder.motion(values);
}

TEST(VirtualVehicle, SaysTheDriveAtTheTimeOfItsOwnClock) {
  const auto drive = test::weaving_drive(5.0);
  VirtualVehicle vehicle(drive, {.rate = 50.0, .clock_drift = 1e-3});
  for (std::size_t k = 0; k < 240; ++k) {
    EXPECT_EQ(vehicle.due(), static_cast<Nanoseconds>(k) * kSecond / 50);
    const io::PacketMotion m = decoded_motion(vehicle.next().value());
    const recording::MotionSample& s = drive[2 * k];
    EXPECT_NEAR(m.time, 1000.0 + 0.02 * static_cast<double>(k) * 1.001, 1e-9);
    EXPECT_NEAR(m.position.x(), s.position.x(), 1e-4) << k;
    EXPECT_NEAR(m.position.y(), s.position.y(), 1e-4);
    EXPECT_LT((m.acceleration - s.force).norm(), 1e-5);
    EXPECT_LT((m.rate - s.rate).norm(), 1e-6);
    EXPECT_LT(m.attitude.angularDistance(s.attitude), 1e-6);
    EXPECT_NEAR(m.velocity.norm(), s.speed, 0.1);
  }
}

TEST(VirtualVehicle, IsPutBackToTheStartAtTheEnd) {
  const auto drive = test::weaving_drive(2.0);
  VirtualVehicle vehicle(drive);
  std::vector<double> x;
  for (int k = 0; k < 500; ++k) x.push_back(decoded_motion(vehicle.next().value()).position.x());
  for (std::size_t k = 0; k < 150; ++k) EXPECT_NEAR(x[k + 200], x[k], 1e-3) << k;
  EXPECT_GT(x[199], 25.0);
}

TEST(VirtualVehicle, LosesAndDelaysWhatItIsTold) {
  VirtualVehicle vehicle(test::weaving_drive(2.0), {.jitter = 0.03, .loss = 0.1});
  Nanoseconds last = 0, most = 0;
  constexpr int kPackets = 5000;
  for (int k = 0; k < kPackets; ++k) {
    const Nanoseconds due = vehicle.due(), at = Nanoseconds{k} * kSecond / 100;
    EXPECT_GE(due, last) << "none overtakes another";
    EXPECT_GE(due, at);
    most = std::max(most, due - at);
    last = due;
    static_cast<void>(vehicle.next());
  }
  EXPECT_LE(most, 30 * kMillisecond);
  EXPECT_GT(most, 29 * kMillisecond);
  EXPECT_EQ(vehicle.sent() + vehicle.lost(), static_cast<std::uint64_t>(kPackets));
  // Three standard deviations of a share of 5000.
  EXPECT_NEAR(static_cast<double>(vehicle.lost()) / kPackets, 0.1, 3.0 * std::sqrt(0.1 * 0.9 / kPackets));
}

}  // namespace
}  // namespace veridyn::live
