#include "veridyn/io/packets/packet_decoder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/folders.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/packets/known_packets.hpp"

namespace veridyn::io {
namespace {

TEST(KnownPackets, OutSimIsOfTheWorldAndWithoutGravity) {
  const std::filesystem::path file =
      test::shared_folder() / "data" / "vehicle" / "lfs_packets" / "OutSimPack_without_OutSim_ID.bin";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file << "; DecodesAPacketByHand is without it";
  const PacketDecoder decoder(known_packet("outsim"));
  std::vector<double> values(decoder.layout().fields.size());
  ASSERT_TRUE(decoder.decode(read_file(file), values));
  ASSERT_TRUE(decoder.is_plausible(values));
  const PacketMotion m = decoder.motion(values);
  // The car drives where it points; its course is the velocity's in the world.
  const Eigen::Vector3d forward = m.attitude * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(
      std::remainder(std::atan2(m.velocity.y(), m.velocity.x()) - std::atan2(forward.y(), forward.x()), 2.0 * kPi), 0.0,
      1e-4);
  EXPECT_NEAR(m.speed, m.velocity.norm(), 0.01);
  EXPECT_GT(m.acceleration.x(), 4.0) << "it speeds up";
  EXPECT_LT(std::abs(m.acceleration.z()), 1.0);
}

TEST(KnownPackets, DecodesAPacketByHand) {
  // Time 1500 ms, heading 90 deg anticlockwise from north, nose up 0.1 rad; 2 m/s^2 and 10 m/s to the west.
  std::string bytes(64, '\0');
  const auto put = [&](std::size_t at, auto number) { std::memcpy(bytes.data() + at, &number, sizeof number); };
  put(0, std::uint32_t{1500});
  put(16, static_cast<float>(kPi / 2.0));
  put(20, 0.1F);
  put(28, -2.0F);
  put(40, -10.0F);
  put(56, std::int32_t{-65536});
  const PacketDecoder decoder(known_packet("outsim"));
  std::vector<double> values(decoder.layout().fields.size());
  ASSERT_TRUE(decoder.decode(bytes, values));
  const PacketMotion m = decoder.motion(values);
  EXPECT_DOUBLE_EQ(m.time, 1.5);
  EXPECT_DOUBLE_EQ(m.position.y(), -1.0);
  EXPECT_NEAR((m.attitude * Eigen::Vector3d::UnitX() - Eigen::Vector3d(-std::cos(0.1), 0.0, std::sin(0.1))).norm(), 0.0,
              1e-7);
  EXPECT_NEAR(m.acceleration.x(), 2.0 * std::cos(0.1), 1e-7);
  EXPECT_NEAR(m.acceleration.z(), -2.0 * std::sin(0.1), 1e-7);
  EXPECT_NEAR(m.speed, 10.0 * std::cos(0.1), 1e-6);
  EXPECT_FALSE(decoder.decode(bytes + "x", values));
  EXPECT_FALSE(decoder.decode(bytes.substr(1), values));
  std::vector<double> of_beamng(known_packet("beamng").fields.size());
  EXPECT_FALSE(PacketDecoder(known_packet("beamng")).decode(std::string(88, 'B'), of_beamng)) << "BNG1 is missing";
}

/// Fields of this order, each a number of single precision without a unit.
PacketLayout floats_layout(const std::vector<std::string>& names) {
  PacketLayout layout;
  layout.name = "floats";
  layout.size = 4 * names.size();
  for (std::size_t i = 0; i < names.size(); ++i) layout.fields.push_back({.name = names[i], .offset = 4 * i});
  return layout;
}

const std::vector<std::string> kDriveFields{"time",       "speed",      "pos_x",      "pos_y",     "pos_z",
                                            "velocity_x", "velocity_y", "velocity_z", "forward_x", "forward_y",
                                            "forward_z",  "right_x",    "right_y",    "right_z"};

/// Those fields of a car at the heading `yaw` with its nose up by `climb`, driving forward at 20 m/s.
std::vector<double> driving(double yaw, double climb) {
  return {3.0,
          20.0,
          1.0,
          2.0,
          0.5,
          20.0,
          0.0,
          0.0,
          std::cos(yaw) * std::cos(climb),
          std::sin(yaw) * std::cos(climb),
          std::sin(climb),
          std::sin(yaw),
          -std::cos(yaw),
          0.0};
}

TEST(PacketDecoder, TakesTheAttitudeFromAxesAsFromAngles) {
  const PacketDecoder by_axes(floats_layout(kDriveFields)), by_angles(floats_layout({"time", "roll", "pitch", "yaw"}));
  for (const double yaw : {0.3, 2.0, -2.5}) {
    const PacketMotion m = by_axes.motion(driving(yaw, 0.2));
    // In flu a nose that is up is a negative pitch.
    const PacketMotion angles = by_angles.motion(std::vector<double>{3.0, 0.0, -0.2, yaw});
    EXPECT_LT(m.attitude.angularDistance(angles.attitude), 1e-9) << yaw;
    // The velocity is the body's: forward, turned into the world.
    EXPECT_LT((m.velocity -
               20.0 * Eigen::Vector3d(std::cos(yaw) * std::cos(0.2), std::sin(yaw) * std::cos(0.2), std::sin(0.2)))
                  .norm(),
              1e-9);
    EXPECT_EQ(m.speed, 20.0);
    EXPECT_TRUE(std::isnan(m.acceleration.x())) << "no field says it";
  }
}

TEST(PacketDecoder, TellsADriveFromOtherNumbers) {
  const PacketDecoder decoder(floats_layout(kDriveFields));
  const auto changed = [&](const char* field, double value) {
    std::vector<double> values = driving(0.3, 0.0);
    values[decoder.layout().find(field)] = value;
    return decoder.is_plausible(values);
  };
  EXPECT_TRUE(decoder.is_plausible(driving(0.3, 0.0)));
  EXPECT_TRUE(changed("pos_x", 5e5));
  EXPECT_FALSE(changed("pos_x", 5e6)) << "beyond any place";
  EXPECT_FALSE(changed("speed", 21.0)) << "not the length of the velocity";
  EXPECT_FALSE(changed("forward_x", 0.5)) << "no unit vector";
  EXPECT_FALSE(changed("right_z", 0.4)) << "none either";
  EXPECT_FALSE(changed("time", -1.0));
  EXPECT_FALSE(changed("time", 1e-9)) << "a count, read as a float";
  EXPECT_FALSE(changed("velocity_z", std::nan("")));
  EXPECT_FALSE(decoder.is_plausible(std::vector<double>(kDriveFields.size(), 0.0))) << "a menu";
}

}  // namespace
}  // namespace veridyn::io
