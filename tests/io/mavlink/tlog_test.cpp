#include "veridyn/io/mavlink/tlog.hpp"

#include <algorithm>
#include <cmath>

#include "tests/io/support.hpp"
#include "tests/support/synthetic_logs.hpp"
#include "tests/support/tlog_writer.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/io/read.hpp"

namespace veridyn::io {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::message_of;
using testing::pack;
using testing::TlogWriter;

std::string attitude(std::uint32_t boot_ms, float roll) { return pack(boot_ms, roll, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F); }

TEST(Tlog, ReadsBothVersionsInSiWithUnknownNumbersLeftOut) {
  const Log log = read_tlog(testing::small_tlog(), "small.tlog");
  EXPECT_FALSE(log.damage.any());
  const Recording recording = to_recording(log);
  const auto value = [&](const char* name, std::size_t i) { return recording.at(name).value[i]; };
  EXPECT_NEAR(value("ATTITUDE.roll", 5), 0.1 * std::sin(1.5), 1e-7);
  EXPECT_NEAR(value("RAW_IMU.xacc", 30), 0.3 * kGravity, 1e-9);
  EXPECT_NEAR(value("RAW_IMU.zacc", 30), -kGravity, 1e-9);
  EXPECT_NEAR(value("RAW_IMU.xgyro", 0), 0.5, 1e-12);
  EXPECT_NEAR(value("RAW_IMU.zmag", 0), 400e-7, 1e-12);
  EXPECT_NEAR(value("GLOBAL_POSITION_INT.lat", 3), 47.3000003 * kDegree, 1e-12);
  EXPECT_NEAR(value("GLOBAL_POSITION_INT.vx", 20), 2.0, 1e-12);
  EXPECT_NEAR(value("GLOBAL_POSITION_INT.vz", 20), 0.3, 1e-12);
  EXPECT_TRUE(std::isnan(value("GLOBAL_POSITION_INT.hdg", 0))) << "65535 says that there is none";
  EXPECT_NEAR(value("GPS_RAW_INT.vel", 2), 22.1, 1e-12);
  EXPECT_NEAR(value("GPS_RAW_INT.alt", 2), 506.0, 1e-12);
  EXPECT_NEAR(value("SCALED_PRESSURE.press_abs", 0), 95050.0, 1e-2) << "a packet of version 1";
  EXPECT_NEAR(value("SCALED_PRESSURE.temperature", 0), 291.15, 1e-9);
  EXPECT_NEAR(value("SERVO_OUTPUT_RAW.servo2_raw", 10), 1550e-6, 1e-12);
  EXPECT_NEAR(value("VFR_HUD.throttle", 0), 0.55, 1e-12);
  EXPECT_EQ(recording.find("SERVO_OUTPUT_RAW.servo9_raw"), nullptr) << "an extension that was not sent";
  EXPECT_NE(recording.find("SERVO_OUTPUT_RAW.servo5_raw"), nullptr);
  EXPECT_EQ(recording.at("ATTITUDE.roll").size(), 40U);
  EXPECT_EQ(recording.information.at("format"), "MAVLink telemetry log");
}

TEST(Tlog, TellsSystemsAndComponentsApartAndReadsTheStory) {
  const Log log = read_tlog(testing::small_tlog(), "small.tlog");
  ASSERT_NE(log.find("component154.ATTITUDE"), nullptr);
  EXPECT_DOUBLE_EQ(log.find("component154.ATTITUDE")->find("roll")->value(0), 9.0);
  ASSERT_NE(log.find("system2.ATTITUDE"), nullptr);
  EXPECT_EQ(log.find("system2.ATTITUDE")->size(), 8U);
  EXPECT_EQ(log.information.at("autopilot"), "ArduPilot");
  EXPECT_THAT(log.information.at("messages not read"), HasSubstr("8 packets of 1 kinds (ids 11000)"));
  EXPECT_DOUBLE_EQ(log.parameters.at("SERVO2_FUNCTION"), 19.0);
  std::vector<std::string> events;
  for (const Event& event : log.events) events.push_back(event.kind + ": " + event.text);
  EXPECT_THAT(events, ::testing::UnorderedElementsAre("armed: disarmed", "armed: armed", "message: Throttle armed"));
}

// The link is late by 70 ms in three packets of four; the vehicle stamped them every 50 ms.
TEST(Tlog, TakesTheVehiclesOwnTimeMovedByTheLeastDelay) {
  const Log log = read_tlog(testing::small_tlog(), "small.tlog");
  const LogTopic& own = *log.find("ATTITUDE");
  const LogTopic& without = *log.find("VFR_HUD");
  for (std::size_t i = 0; i < own.size(); ++i) {
    EXPECT_NEAR((*own.time)[i], 0.010 + 0.050 * static_cast<double>(i), 1e-9);
    EXPECT_NEAR((*without.time)[i], (*own.time)[i], 1e-9) << "received with the packets before it";
  }
  EXPECT_NEAR((*log.find("SERVO_OUTPUT_RAW")->time)[7], 0.360, 1e-9) << "32 bits of microseconds";
}

TEST(Tlog, GoesOnWhereTheVehicleStartsAnew) {
  TlogWriter log;
  for (std::uint32_t i = 0; i < 50; ++i) log.packet(20'000ULL * i, 30, 39, attitude(500'000 + 20 * i, 1.0F));
  for (std::uint32_t i = 0; i < 50; ++i) log.packet(90'000'000 + 20'000ULL * i, 30, 39, attitude(3000 + 20 * i, 2.0F));
  const Log read = read_tlog(log.bytes(), "two.tlog");
  const LogTopic& topic = *read.find("ATTITUDE");
  ASSERT_EQ(topic.size(), 100U);
  EXPECT_NEAR((*topic.time)[49], 0.98, 1e-9);
  EXPECT_NEAR((*topic.time)[50], 90.0, 1e-9);
  EXPECT_DOUBLE_EQ(topic.find("roll")->value(50), 2.0);
  EXPECT_THAT(read.damage.notes, Contains(HasSubstr("restarted 1 time;")));
  ASSERT_EQ(read.restarts.size(), 1U);
  EXPECT_NEAR(read.restarts[0], 90.0, 1e-9);
}

TEST(Tlog, NumbersTheSensorsThatAMessageNumbers) {
  TlogWriter log;
  for (std::uint32_t i = 0; i < 10; ++i)
    for (std::uint8_t id = 0; id < 2; ++id)
      log.packet(100'000ULL * i, 295, 234,
                 pack(15.0F + static_cast<float>(id), 1.5F, std::int16_t{2000}, id, std::uint8_t{0}));
  const Recording recording = to_recording(read_tlog(log.bytes(), "two.tlog"));
  EXPECT_DOUBLE_EQ(recording.at("AIRSPEED.airspeed").value[3], 15.0);
  EXPECT_DOUBLE_EQ(recording.at("AIRSPEED[1].airspeed").value[3], 16.0);
  EXPECT_NEAR(recording.at("AIRSPEED.raw_press").value[0], 150.0, 1e-9);
}

TEST(Tlog, LeavesOutAndCountsPacketsThatAreDamaged) {
  const std::string whole = testing::small_tlog();
  const Log sound = read_tlog(whole, "whole.tlog");
  // A bit of the roll of one ATTITUDE: its checksum is wrong.
  TlogWriter writer;
  for (std::uint32_t i = 0; i < 20; ++i) writer.packet(20'000ULL * i, 30, 39, attitude(1000 + 20 * i, 1.0F));
  std::string bytes = writer.bytes();
  const std::size_t size = bytes.size() / 20;
  bytes[7 * size + 8 + 10 + 6] ^= 1;
  const Log one = read_tlog(bytes, "one.tlog");
  EXPECT_EQ(one.find("ATTITUDE")->size(), 19U);
  EXPECT_EQ(one.damage.records_lost, 1U);
  EXPECT_EQ(one.damage.bytes_lost, size);
  EXPECT_THAT(one.damage.notes, Contains("1 packets with a wrong checksum"));
  // Rubbish in between, and an end within a packet.
  const std::string rubbish = bytes.substr(0, 3 * size) + "rubbish" + bytes.substr(3 * size, 2 * size + 11);
  const Log cut = read_tlog(rubbish, "cut.tlog");
  EXPECT_EQ(cut.find("ATTITUDE")->size(), 5U);
  EXPECT_EQ(cut.damage.bytes_lost, 7U + 11U);
  // A message with the layout of another dialect fails the check that starts from its own CRC_EXTRA.
  TlogWriter other;
  for (std::uint32_t i = 0; i < 20; ++i) {
    other.packet(20'000ULL * i, 30, 39, attitude(1000 + 20 * i, 1.0F));
    other.packet(20'000ULL * i, 33, 105, std::string(28, 'x'));
  }
  const Log dialect = read_tlog(other.bytes(), "dialect.tlog");
  EXPECT_EQ(dialect.find("GLOBAL_POSITION_INT"), nullptr);
  EXPECT_EQ(dialect.damage.records_lost, 20U);
  EXPECT_EQ(sound.damage.records_lost, 0U);
}

TEST(Tlog, OfAnyLengthOrWithAnyByteWrongIsReadOrRefused) {
  const std::string bytes = testing::small_tlog();
  for (std::size_t size = 1; size < bytes.size(); size += 61) {
    try {
      testing::expect_consistent(read_tlog(std::string_view(bytes).substr(0, size), "cut.tlog"), size);
    } catch (const InputError&) {
      EXPECT_LT(size, 200U);
    }
  }
  for (std::size_t at = 200; at < bytes.size(); at += 37) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    const Log log = read_tlog(damaged, "damaged.tlog");
    testing::expect_consistent(log, bytes.size());
    EXPECT_LE(log.damage.records_lost, 1U) << at;
  }
}

TEST(Tlog, IsRecognisedByItsContent) {
  EXPECT_TRUE(is_tlog(testing::small_tlog()));
  EXPECT_FALSE(is_tlog(testing::small_ulog()));
  EXPECT_FALSE(is_tlog(""));
  EXPECT_FALSE(is_tlog(std::string(4096, '\0')));
  const testing::TemporaryFolder folder;
  EXPECT_EQ(read_log(folder.write("flight.bytes", testing::small_tlog())).format, "MAVLink telemetry log");
  EXPECT_THAT(message_of([] { (void)read_tlog("no telemetry log, but a text", "x.tlog"); }),
              HasSubstr("not a telemetry log of MAVLink"));
  EXPECT_THAT(message_of([] { (void)read_tlog("", "x.tlog"); }), HasSubstr("empty"));
}

}  // namespace
}  // namespace veridyn::io
