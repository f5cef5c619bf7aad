#include "veridyn/io/packets/known_packets.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/support/folders.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/packets/packet_decoder.hpp"

namespace veridyn::io {
namespace {

std::string unhex(const std::string& hex) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return bytes;
}

/// Our name of a field of Live for Speed's.
std::string ours(std::string name) {
  static const std::map<std::string, std::string> plain = {{"Time", "time"},
                                                           {"ID", "id"},
                                                           {"AngVelX", "ang_vel_x"},
                                                           {"AngVelY", "ang_vel_y"},
                                                           {"AngVelZ", "ang_vel_z"},
                                                           {"Heading", "yaw"},
                                                           {"Pitch", "pitch"},
                                                           {"Roll", "roll"},
                                                           {"AccelX", "world_accel_x"},
                                                           {"AccelY", "world_accel_y"},
                                                           {"AccelZ", "world_accel_z"},
                                                           {"VelX", "world_velocity_x"},
                                                           {"VelY", "world_velocity_y"},
                                                           {"VelZ", "world_velocity_z"},
                                                           {"PosX", "pos_x"},
                                                           {"PosY", "pos_y"},
                                                           {"PosZ", "pos_z"},
                                                           {"Throttle", "throttle"},
                                                           {"Brake", "brake"},
                                                           {"InputSteer", "steering"},
                                                           {"Clutch", "clutch"},
                                                           {"Handbrake", "hand_brake"},
                                                           {"Gear", "gear"},
                                                           {"EngineAngVel", "engine_speed"},
                                                           {"MaxTorqueAtVel", "engine_torque_most"},
                                                           {"CurrentLapDist", "lap_distance"},
                                                           {"IndexedDistance", "indexed_distance"},
                                                           {"SteerTorque", "steering_torque"},
                                                           {"PLID", "player"},
                                                           {"Speed", "speed"},
                                                           {"RPM", "engine_speed"},
                                                           {"Turbo", "turbo"},
                                                           {"Fuel", "fuel"}};
  static const std::map<std::string, std::string> of_wheel = {
      {"SuspDeflect", "suspension_"},  {"Steer", "steer_"},
      {"XForce", "force_right_"},      {"YForce", "force_forward_"},
      {"VerticalLoad", "load_"},       {"AngVel", "wheel_"},
      {"LeanRelToRoad", "lean_"},      {"AirTemp", "air_temperature_"},
      {"SlipFraction", "slip_share_"}, {"Touching", "touching_"},
      {"SlipRatio", "slip_ratio_"},    {"TanSlipAngle", "tan_slip_angle_"}};
  for (const char* part : {"OSMain.", "OSInputs."}) {
    if (name.starts_with(part)) name = name.substr(std::string(part).size());
  }
  if (name.starts_with("OSWheels[")) {
    constexpr std::array wheels = {"rl", "rr", "fl", "fr"};
    return of_wheel.at(name.substr(12)) + wheels.at(static_cast<std::size_t>(name[9] - '0'));
  }
  return plain.contains(name) ? plain.at(name) : "";
}

/// What the sender calls this number, from what we decoded.
double as_sent(const PacketField& f, double value) { return (value - f.bias) / f.factor; }

TEST(KnownPackets, AreOfTheirSizes) {
  const std::map<std::string, std::size_t> sizes = {
      {"outsim", 64},      {"outsim_id", 68},    {"outsim2", 280},       {"outgauge", 92},    {"outgauge_id", 96},
      {"motion_68", 68},   {"codemasters", 264}, {"forza_sled", 232},    {"forza_dash", 311}, {"forza_horizon", 324},
      {"forza_2023", 331}, {"beamng", 88},       {"assetto_corsa", 328}, {"veridyn", 76}};
  ASSERT_EQ(known_packets().size(), sizes.size());
  for (const auto& [name, size] : sizes) EXPECT_EQ(known_packet(name).size, size) << name;
  EXPECT_THROW(static_cast<void>(known_packet("outsin")), InputError);
  // Parts of OutSim2 that are not asked for take no room.
  EXPECT_EQ(outsim2(0xff).size, 272U);
  EXPECT_EQ(outsim2(4 + 8).size, 64U);
  EXPECT_EQ(outsim2(4 + 8).fields[1].offset, known_packet("outsim").fields[1].offset);
}

TEST(KnownPackets, DecodeEveryCapturedPacketOfLiveForSpeed) {
  const std::filesystem::path folder = test::shared_folder() / "data" / "vehicle" / "lfs_packets";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder << "; DecodesAPacketByHand is without it";
  const std::map<std::string, std::uint32_t> parts = {{"ID", 2},       {"Time", 4},    {"Main", 8},
                                                      {"Inputs", 16},  {"Drive", 32},  {"Distance", 64},
                                                      {"Wheels", 128}, {"Extra", 256}, {"All_data", 0x1ff}};
  const auto vectors = nlohmann::json::parse(std::ifstream(folder / "vectors.json"))["vectors"];
  std::size_t packets = 0, numbers = 0;
  for (const auto& vector : vectors) {
    const std::string file = vector["file"];
    PacketLayout layout;
    if (file.starts_with("OutSimPack_"))
      layout = known_packet(file.find("without") != std::string::npos ? "outsim" : "outsim_id");
    if (file.starts_with("OutGauge"))
      layout = known_packet(file.find("without") != std::string::npos ? "outgauge" : "outgauge_id");
    for (const auto& [part, bit] : parts) {
      if (file == "OutSimPack2_" + part + ".bin") layout = outsim2(bit);
    }
    if (layout.fields.empty()) {
      EXPECT_EQ(file, "OutSimPack2_Header.bin");
      continue;
    }
    const std::string bytes = read_file(folder / file);
    EXPECT_EQ(bytes, unhex(vector["hex"])) << file;
    const PacketDecoder decoder(layout);
    std::vector<double> values(layout.fields.size());
    ASSERT_TRUE(decoder.decode(bytes, values)) << file;
    ++packets;
    const auto expect = [&](const std::string& name, double sent) {
      const std::size_t at = layout.find(ours(name));
      ASSERT_LT(at, values.size()) << file << " " << name;
      // Printed from floats: nine digits.
      EXPECT_NEAR(as_sent(layout.fields[at], values[at]), sent, 1e-6 * std::max(1e-6, std::abs(sent)))
          << file << " " << name;
      ++numbers;
    };
    for (const auto& [name, text] : vector["nonzero_fields"].items()) {
      const std::string value = text;
      if (value.starts_with("'") || value.find("Flags") != std::string::npos ||
          value.find("DashLights") != std::string::npos)
        continue;
      if (!value.starts_with("[")) {
        expect(name, std::stod(value));
        continue;
      }
      std::string rest = value.substr(1);
      for (const char* axis : {"X", "Y", "Z"}) {
        std::size_t read = 0;
        expect(name + axis, std::stod(rest, &read));
        rest = rest.substr(std::min(rest.size(), rest.find(',') + 1));
      }
    }
  }
  EXPECT_EQ(packets, 13U);
  EXPECT_GT(numbers, 150U);
}

}  // namespace
}  // namespace veridyn::io
