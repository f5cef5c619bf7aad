#include "veridyn/io/packets/packet_log.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "tests/support/folders.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/packets/known_packets.hpp"
#include "veridyn/io/packets/packet_decoder.hpp"

namespace veridyn::io {
namespace {

constexpr double kRadius = 20.0, kSpeed = 10.0, kOmega = kSpeed / kRadius;

/// A circle to the left at 10 m/s from `begin` [s], 100 packets a second, by who writes OutSim.
std::string outsim_circle(int count, double begin = 5.0) {
  std::string bytes;
  for (int k = 0; k < count; ++k) {
    std::string p(68, '\0');
    const auto put = [&](std::size_t at, auto number) { std::memcpy(p.data() + at, &number, sizeof number); };
    const auto put3 = [&](std::size_t at, double x, double y) {
      put(at, static_cast<float>(x));
      put(at + 4, static_cast<float>(y));
    };
    const double t = begin + 0.01 * k, angle = kOmega * t;
    put(0, static_cast<std::uint32_t>(std::lround(1e3 * t)));
    put(16, static_cast<float>(std::remainder(angle - kPi / 2.0, 2.0 * kPi)));
    put3(28, -kSpeed * kOmega * std::sin(angle), kSpeed * kOmega * std::cos(angle));
    put3(40, kSpeed * std::cos(angle), kSpeed * std::sin(angle));
    put(52, static_cast<std::int32_t>(std::lround(65536.0 * kRadius * std::sin(angle))));
    put(56, static_cast<std::int32_t>(std::lround(-65536.0 * kRadius * std::cos(angle))));
    bytes += p;
  }
  return bytes;
}

/// The same packets with a time in seconds, as the platform program of 68 bytes has them.
std::string motion_68_circle(int count) {
  std::string bytes = outsim_circle(count);
  for (int k = 0; k < count; ++k) {
    char* p = bytes.data() + 68 * k;
    std::uint32_t ms = 0;
    std::memcpy(&ms, p, sizeof ms);
    std::string moved(68, '\0');
    const auto time = static_cast<float>(1e-3 * ms);
    std::memcpy(moved.data(), &time, 4);
    std::memcpy(moved.data() + 4, p + 16, 12);   // angles
    std::memcpy(moved.data() + 16, p + 28, 24);  // acceleration, velocity
    std::memcpy(moved.data() + 52, p + 52, 16);
    std::memcpy(p, moved.data(), 68);
  }
  return bytes;
}

TEST(PacketLog, ACircleToTheLeftIsOneByEitherPacketOf68Bytes) {
  for (const auto& [name, bytes] :
       {std::pair("outsim_id", outsim_circle(500)), std::pair("motion_68", motion_68_circle(500))}) {
    const PacketLayout* layout = packets_in(bytes);
    ASSERT_TRUE(layout != nullptr) << name;
    EXPECT_EQ(layout->name, name) << "told by content";
    const Recording r = to_recording(packet_log(*layout, bytes, "circle"));
    EXPECT_EQ(r.frame, Frame::kFlu);
    for (const std::size_t k : {20U, 250U, 480U}) {
      EXPECT_NEAR(r.at("accel_x").value[k], 0.0, 1e-5);
      EXPECT_NEAR(r.at("accel_y").value[k], kSpeed * kOmega, 1e-5);
      EXPECT_NEAR(r.at("gyro_z").value[k], kOmega, 1e-3) << "derived";
      EXPECT_NEAR(r.at("speed").value[k], kSpeed, 1e-5);
      const double heading = std::atan2(r.at("pos_y").value[k + 1] - r.at("pos_y").value[k - 1],
                                        r.at("pos_x").value[k + 1] - r.at("pos_x").value[k - 1]);
      EXPECT_NEAR(std::remainder(r.at("yaw").value[k] - heading, 2.0 * kPi), 0.0, 1e-3);
    }
  }
}

TEST(PacketLog, CountsWhatItLeavesOut) {
  std::string bytes = outsim_circle(100);
  bytes += bytes.substr(bytes.size() - 68);           // repeated
  bytes += bytes.substr(bytes.size() - 10 * 68, 68);  // out of order
  std::string broken = bytes.substr(0, 68);
  const float nan = std::nanf("");
  std::memcpy(broken.data() + 28, &nan, 4);
  bytes += broken + std::string(68, '\0');
  bytes += outsim_circle(60, 1.0);  // time started again
  const Log log = packet_log(known_packet("outsim_id"), bytes + "cut", "drive");
  EXPECT_EQ(log.topics.front().size(), 100U);
  EXPECT_EQ(log.damage.bytes_lost, 3U);
  ASSERT_FALSE(log.damage.notes.empty());
  EXPECT_EQ(log.damage.notes.front(),
            "64 packets were left out: 2 with a stamp that repeats or goes back, 2 without a drive, 60 of other runs, "
            "between which time started again");
}

TEST(PacketLog, IsNotSeenInOtherBytes) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 200; ++trial) {
    std::string bytes(64 * 68 * 3, '\0');
    for (char& c : bytes) c = static_cast<char>(random());
    EXPECT_EQ(packets_in(bytes), nullptr);
  }
  EXPECT_EQ(packets_in(std::string(68 * 100, '\0')), nullptr);
  EXPECT_EQ(packets_in(""), nullptr);
  EXPECT_EQ(packets_in(outsim_circle(100).substr(4)), nullptr) << "not at the packets' starts";
  EXPECT_EQ(why([] { static_cast<void>(packet_log(known_packet("outsim"), "short", "x.bin")); }),
            "x.bin: holds 0 usable packets of a drive; a recording has 10 at least");
  EXPECT_EQ(why([] { static_cast<void>(packet_log(known_packet("beamng"), "", "x.bin")); }),
            "x.bin: packets of BeamNG MotionSim hold no time: a file of them is no recording");
}

TEST(PacketLog, SpeedOfEveryPacketOfARealDriveIsTheLengthOfItsVelocity) {
  const std::filesystem::path file =
      test::shared_folder() / "data" / "vehicle" / "dirt_rally_2" / "default_packets.f32";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file << "; ACircleToTheLeft... is without it";
  const std::string bytes = read_file(file);
  const PacketDecoder decoder(known_packet("codemasters"));
  const PacketLayout& layout = decoder.layout();
  std::vector<double> p(layout.fields.size());
  std::size_t packets = 0;
  double worst = 0.0;
  for (; (packets + 1) * layout.size <= bytes.size(); ++packets) {
    ASSERT_TRUE(decoder.decode(std::string_view(bytes).substr(packets * layout.size, layout.size), p));
    const PacketMotion m = decoder.motion(p);
    worst = std::max(worst, std::abs(m.velocity.norm() - p[layout.find("speed")]));
  }
  EXPECT_EQ(packets, 12151U);
  EXPECT_LT(worst, 4.5e-6) << "a float of 40 m/s is right to 1.9e-6, and so are the three of its velocity";
}

}  // namespace
}  // namespace veridyn::io
