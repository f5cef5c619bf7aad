#include "veridyn/live/telemetry/packet_intake.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/live/weaving_drive.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/packets/known_packets.hpp"
#include "veridyn/live/virtual/virtual_vehicle.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::live {
namespace {

using ::testing::HasSubstr;

constexpr Sender kGame{0x7f000001, 5000}, kStranger{0x7f000001, 5001};

/// Packets of a weaving car, each with its time of arrival.
struct TimedPacket {
  std::string bytes;
  Nanoseconds arrival = 0;
};

std::vector<TimedPacket> packets(double duration, const VirtualVehicleOptions& options = {}) {
  VirtualVehicle vehicle(test::weaving_drive(duration + 1.0), options);
  std::vector<TimedPacket> all;
  while (vehicle.due() < nanoseconds(duration)) {
    const Nanoseconds due = vehicle.due();
    if (const auto p = vehicle.next()) all.push_back({std::string(*p), due + kSecond});
  }
  return all;
}

PacketIntake intake_of(const char* name) { return PacketIntake({io::known_packet(name)}); }

PacketStatus fate_of(PacketIntake& intake, const TimedPacket& p, const Sender& sender = kGame) {
  static_cast<void>(intake.take({p.bytes, sender, p.arrival}));
  return intake.last_status();
}

TEST(PacketIntake, LetsADriveThroughWithItsMotion) {
  PacketIntake intake = intake_of("veridyn");
  const auto drive = test::weaving_drive(4.0);
  std::size_t k = 0;
  for (const TimedPacket& p : packets(3.0)) {
    const auto t = intake.take({p.bytes, kGame, p.arrival});
    ASSERT_TRUE(t);
    EXPECT_EQ(t->restarted, k == 0);
    EXPECT_EQ(t->arrival, p.arrival);
    const auto& truth = drive[k];
    EXPECT_NEAR(t->sample.time, 1000.0 + truth.time, 1e-9);
    EXPECT_LT((t->sample.force - truth.force).norm(), 1e-5);
    EXPECT_LT((t->sample.rate - truth.rate).norm(), 1e-6);
    EXPECT_LT(t->sample.attitude.angularDistance(truth.attitude), 1e-6);
    // Velocities are differences of places; at the beginning to one side only.
    EXPECT_NEAR(t->sample.speed, truth.speed, k == 0 ? 2e-2 : 2e-3);
    // Of the last 60 ms, so 30 ms late.
    if (k > 10) {
      EXPECT_NEAR(t->sample.angular_acceleration.z(), drive[k - 3].angular_acceleration.z(), 1e-3) << k;
    }
    ++k;
  }
  EXPECT_EQ(intake.counts()[PacketStatus::kAccepted], k);
  EXPECT_EQ(intake.drives(), 1U);
}

TEST(PacketIntake, CountsWhatItRejectsByKindAndSender) {
  PacketIntake intake = intake_of("veridyn");
  std::vector<TimedPacket> all = packets(2.0);
  for (std::size_t k = 0; k < 100; ++k) ASSERT_EQ(fate_of(intake, all[k]), PacketStatus::kAccepted);
  TimedPacket p = all[100];
  p.bytes.pop_back();
  EXPECT_EQ(fate_of(intake, p), PacketStatus::kWrongSize);
  p.bytes += "12";
  EXPECT_EQ(fate_of(intake, p), PacketStatus::kWrongSize);
  p = all[100];
  p.bytes[0] = 'X';
  EXPECT_EQ(fate_of(intake, p), PacketStatus::kWrongSize);
  p = all[100];
  const float nan = std::nanf("");
  std::memcpy(p.bytes.data() + 40, &nan, 4);
  EXPECT_EQ(fate_of(intake, p), PacketStatus::kImplausible);
  p = all[99];
  EXPECT_EQ(fate_of(intake, p), PacketStatus::kRepeated);
  EXPECT_EQ(fate_of(intake, all[97]), PacketStatus::kOutOfOrder);
  p = all[100];
  p.arrival += nanoseconds(0.3);
  EXPECT_EQ(fate_of(intake, p), PacketStatus::kStale);
  p = all[100];
  const float far = 900.0F;
  std::memcpy(p.bytes.data() + 16, &far, 4);
  EXPECT_EQ(fate_of(intake, p), PacketStatus::kTeleporting);
  EXPECT_EQ(fate_of(intake, all[100], kStranger), PacketStatus::kOtherSender);
  EXPECT_EQ(fate_of(intake, all[100]), PacketStatus::kAccepted);
  const auto senders = intake.senders();
  ASSERT_EQ(senders.size(), 2U);
  EXPECT_EQ(senders[0].sender, kGame);
  EXPECT_EQ(senders[0].counts[PacketStatus::kWrongSize], 3U);
  EXPECT_EQ(senders[1].counts[PacketStatus::kOtherSender], 1U);
  EXPECT_EQ(intake.counts()[PacketStatus::kAccepted], 101U);
}

TEST(PacketIntake, BeginsAgainWhereADriveIsPutBackAndSaysSo) {
  PacketIntake intake = intake_of("veridyn");
  const std::vector<TimedPacket> all = packets(4.0);
  for (std::size_t k = 0; k < 300; ++k) ASSERT_EQ(fate_of(intake, all[k]), PacketStatus::kAccepted);
  // The game loads a state of 3 s before; its clock goes back with it.
  std::size_t until = 0;
  bool restarted = false;
  for (std::size_t k = 0; k < 20 && !restarted; ++k) {
    TimedPacket p = all[k];
    p.arrival = all[300].arrival + all[k].arrival - all[0].arrival;
    const auto t = intake.take({p.bytes, kGame, p.arrival});
    restarted = t && t->restarted;
    ++until;
  }
  EXPECT_TRUE(restarted);
  EXPECT_EQ(until, IntakeOptions().begins_again);
  EXPECT_EQ(intake.drives(), 2U);
}

TEST(PacketIntake, ListensToAnotherSenderOnceTheFirstIsSilent) {
  PacketIntake intake = intake_of("veridyn");
  const std::vector<TimedPacket> all = packets(4.0);
  for (std::size_t k = 0; k < 100; ++k) fate_of(intake, all[k]);
  EXPECT_EQ(fate_of(intake, all[150], kStranger), PacketStatus::kOtherSender);  // half a second of silence
  EXPECT_EQ(fate_of(intake, all[250], kStranger), PacketStatus::kAccepted);
  EXPECT_EQ(fate_of(intake, all[251], kGame), PacketStatus::kOtherSender);
  EXPECT_EQ(intake.drives(), 2U);
}

TEST(PacketIntake, FindsOutByContentWhichPacketsTheyAre) {
  // As long as each other: OutSim with an ID counts milliseconds, the other packet of 68 bytes has floats.
  const std::vector<io::PacketLayout> both = {io::known_packet("outsim_id"), io::known_packet("motion_68")};
  for (const io::PacketLayout& layout : both) {
    PacketIntake intake(both);
    const auto drive = test::weaving_drive(3.0);
    std::vector<double> values(layout.fields.size(), 0.0);
    std::string bytes(layout.size, '\0');
    const auto set = [&](const char* name, double value) { values[layout.find(name)] = value; };
    std::size_t accepted = 0;
    for (std::size_t k = 0; k < 200; ++k) {
      const recording::MotionSample& s = drive[k];
      const Eigen::Vector3d a = s.attitude * (s.force - Eigen::Vector3d(0.0, 0.0, kGravity)),
                            v = s.attitude * Eigen::Vector3d(s.speed, 0.0, 0.0);
      set("time", 10.0 + s.time);
      set("yaw", 0.3 * std::sin(0.8 * s.time));
      set("world_accel_x", a.x());
      set("world_accel_y", a.y());
      set("world_velocity_x", v.x());
      set("world_velocity_y", v.y());
      set("pos_x", s.position.x());
      set("pos_y", s.position.y());
      io::encode(layout, values, bytes);
      const auto t = intake.take({bytes, kGame, nanoseconds(s.time)});
      if (!t) continue;
      ++accepted;
      EXPECT_LT((t->sample.force - s.force).norm(), 1e-4) << layout.name;
    }
    ASSERT_NE(intake.layout(), nullptr);
    EXPECT_EQ(intake.layout()->name, layout.name);
    EXPECT_GT(accepted, 180U);
    EXPECT_EQ(intake.counts()[PacketStatus::kUnrecognised] + accepted, 200U);
  }
}

TEST(PacketIntake, RefusesLayoutsThatSayNoMotion) {
  const auto refused = [](const char* name) { return why([&] { PacketIntake({io::known_packet(name)}); }); };
  EXPECT_EQ(refused("outgauge"),
            "packet outgauge: holds no acceleration, and not attitude and velocity to derive one from");
  EXPECT_THAT(refused("assetto_corsa"), HasSubstr("holds no acceleration"));
  io::PacketLayout unknown = io::known_packet("veridyn");
  unknown.gravity_in.reset();
  EXPECT_THAT(why([&] { PacketIntake({unknown}); }), HasSubstr("`gravity` is missing"));
}

TEST(PacketIntake, StandsWhateverBytesCome) {
  PacketIntake intake(std::vector<io::PacketLayout>{io::known_packet("veridyn"), io::known_packet("outsim"),
                                                    io::known_packet("outsim_id"), io::known_packet("motion_68")});
  numerics::RandomStream random(5, "bytes");
  const std::vector<TimedPacket> good = packets(1.0);
  std::string bytes;
  std::uint64_t taken = 0;
  for (int k = 0; k < 10000; ++k) {
    const TimedPacket& g = good[static_cast<std::size_t>(k) % good.size()];
    bytes = g.bytes;
    if (random.uniform() < 0.5) bytes.resize(random.index(120));
    for (int n = 0; n < 4 && !bytes.empty(); ++n)
      bytes[random.index(bytes.size())] = static_cast<char>(random.index(256));
    const auto t = intake.take({bytes, kGame, nanoseconds(0.01 * k)});
    if (!t) continue;
    ++taken;
    EXPECT_TRUE(t->sample.force.allFinite() && t->sample.rate.allFinite() && t->sample.attitude.coeffs().allFinite());
  }
  EXPECT_EQ(intake.counts()[PacketStatus::kAccepted], taken);
}

TEST(PacketIntake, TakesTheRecordedPacketsOfAGame) {
  const std::filesystem::path file = veridyn::test::shared_folder() / "data/vehicle/dirt_rally_2/default_packets.f32";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "needs ../shared";
  const std::string bytes = read_file(file);
  PacketIntake intake = intake_of("codemasters");
  const std::size_t size = io::known_packet("codemasters").size;
  ASSERT_EQ(bytes.size() / size, 12151U);
  const std::size_t time = io::known_packet("codemasters").find("time");
  for (std::size_t at = 0; at + size <= bytes.size(); at += size) {
    const std::string_view packet = std::string_view(bytes).substr(at, size);
    float stamp = 0.0F;
    std::memcpy(&stamp, packet.data() + 4 * time, sizeof stamp);
    static_cast<void>(intake.take({packet, kGame, nanoseconds(static_cast<double>(stamp) + 3.0)}));
  }
  // Menus, where everything is zero, and what repeats a stamp, are left out.
  const auto counts = intake.counts();
  EXPECT_GT(counts[PacketStatus::kAccepted], 10000U);
  std::uint64_t all = 0;
  for (const std::uint64_t c : counts) all += c;
  EXPECT_EQ(all, 12151U);
  EXPECT_EQ(intake.derived(), "accelerations and angular rates are derived from the last 60 ms, and 30 ms late");
}

}  // namespace
}  // namespace veridyn::live
