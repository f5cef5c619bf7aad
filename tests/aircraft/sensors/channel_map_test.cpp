#include "veridyn/aircraft/sensors/channel_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

Channel channel(std::string name, std::string_view unit, std::vector<double> value) {
  std::vector<double> time(value.size());
  for (std::size_t i = 0; i < time.size(); ++i) time[i] = 0.1 * static_cast<double>(i);
  return make_channel(std::move(name), unit, make_time_base(std::move(time)), std::move(value));
}

MappedRecording map(const Recording& log, const std::string& table = "", SurfaceThrows throws = {}) {
  static std::vector<Study> studies;  // keeps the document alive
  studies.push_back(Study::parse("[map]\n" + table, "study.toml"));
  return map_channels(log, studies.back().root().table("map"), throws);
}

Recording log_with(std::vector<Channel> channels) {
  Recording log;
  log.source = "flight.bin";
  for (Channel& c : channels) log.add(std::move(c));
  return log;
}

TEST(ChannelMap, KeepsStandardNamesAsTheyAre) {
  const MappedRecording mapped = map(log_with({channel("airspeed", "m/s", {15, 16}), channel("other", "m", {1, 2})}));
  EXPECT_EQ(mapped.recording.names(), std::vector<std::string>{"airspeed"});
  EXPECT_EQ(mapped.log_kind, "standard names");
}

TEST(ChannelMap, AppliesZeroScaleUnitAndDelayOfTheStudy) {
  const MappedRecording mapped =
      map(log_with({channel("CUR2.Volt", "1", {2.5, 3.5})}),
          "alpha = { channel = \"CUR2.Volt\", zero = 2.5, scale = 10, unit = \"deg\", delay = \"20 ms\" }\n");
  const Channel& alpha = mapped.recording.at("alpha");
  EXPECT_THAT(alpha.value, ElementsAre(0.0, DoubleNear(10.0 * kDegree, 1e-15)));
  EXPECT_THAT(alpha.times()[1], DoubleNear(0.08, 1e-15));
}

TEST(ChannelMap, CombinesChannelsByWeight) {
  const MappedRecording mapped =
      map(log_with({channel("l", "1", {0.2, 0.1}), channel("r", "1", {0.0, -0.1})}),
          "aileron = { channels = [\"l\", \"r\"], weights = [0.5, -0.5], unit = \"rad\" }\n");
  EXPECT_THAT(mapped.recording.at("aileron").value, ElementsAre(DoubleNear(0.1, 1e-15), DoubleNear(0.1, 1e-15)));
}

TEST(ChannelMap, SwitchesBetweenChannelsByMode) {
  const MappedRecording mapped =
      map(log_with({channel("mode", "1", {1, 2, 0}), channel("stick", "1", {0.1, 0.1, 0.1}),
                    channel("autopilot", "1", {0.3, 0.3, 0.3})}),
          "elevator = { switch = \"mode\", cases = { 1 = \"stick\", 2 = \"autopilot\" }, unit = \"rad\" }\n");
  const Channel& elevator = mapped.recording.at("elevator");
  EXPECT_DOUBLE_EQ(elevator.value[0], 0.1);
  EXPECT_DOUBLE_EQ(elevator.value[1], 0.3);
  EXPECT_TRUE(std::isnan(elevator.value[2]));
}

TEST(ChannelMap, TakesAChannelAwayOnRequest) {
  const MappedRecording mapped =
      map(log_with({channel("alpha", "rad", {0, 1}), channel("beta", "rad", {0, 1})}), "beta = \"none\"\n");
  EXPECT_EQ(mapped.recording.names(), std::vector<std::string>{"alpha"});
}

TEST(ChannelMap, SaysWhatIsWrongWithAMapping) {
  const Recording log = log_with({channel("ARSP.Airspeed", "m/s", {15, 16}), channel("RCOU.C2", "1", {1500, 1600})});
  EXPECT_EQ(why([&] { map(log, "airspede = \"ARSP.Airspeed\"\n"); }),
            "study.toml:2: map.airspede: is not a standard channel (did you mean 'airspeed'?)");
  EXPECT_EQ(why([&] { map(log, "airspeed = \"ARSP.Airsped\"\n"); }),
            "study.toml:2: map.airspeed: flight.bin has no channel 'ARSP.Airsped' (did you mean 'ARSP.Airspeed'?)");
  EXPECT_EQ(why([&] { map(log, "alpha = \"ARSP.Airspeed\"\n"); }),
            "study.toml:2: map.alpha: channel 'ARSP.Airspeed' is in [m/s], but alpha is in [rad]");
  EXPECT_THAT(why([&] { map(log, "alpha = { channel = \"RCOU.C2\", unit = \"kg\" }\n"); }),
              HasSubstr("study.toml:2: map.alpha.unit: unit 'kg' is a mass [kg], expected an angle [rad]"));
}

TEST(ChannelMap, RefusesAFrameWithZUp) {
  Recording log = log_with({channel("airspeed", "m/s", {1, 2})});
  log.frame = Frame::kFlu;
  EXPECT_THAT(why([&] { map(log); }), HasSubstr("its frame is flu"));
}

TEST(ChannelMap, ListsWhatALogHasWhenSomethingIsMissing) {
  const MappedRecording mapped = map(log_with({channel("airspeed", "m/s", {15, 16})}));
  const std::vector<std::string> needed{"gyro_x", "airspeed"};
  EXPECT_EQ(why([&] { require_channels(mapped, needed, "the rates"); }),
            "flight.bin: has no gyro_x (standard names log), which is needed for the rates; it has airspeed");
}

TEST(ArduPilotMap, TurnsGpsSpeedAndCourseIntoVelocity) {
  const MappedRecording mapped =
      map(log_with({channel("IMU.AccX", "m/s^2", {0, 1}), channel("GPS.Spd", "m/s", {10, 20}),
                    channel("GPS.GCrs", "1", {90, 180}), channel("GPS.VZ", "m/s", {-1, 1})}));
  EXPECT_EQ(mapped.log_kind, "ArduPilot");
  EXPECT_THAT(mapped.recording.at("vel_north").value, ElementsAre(DoubleNear(0.0, 1e-12), DoubleNear(-20.0, 1e-12)));
  EXPECT_THAT(mapped.recording.at("vel_east").value, ElementsAre(DoubleNear(10.0, 1e-12), DoubleNear(0.0, 1e-12)));
  EXPECT_THAT(mapped.recording.at("vel_down").value, ElementsAre(-1.0, 1.0));
}

TEST(ArduPilotMap, FindsServosByFunctionAndHonoursTrimEndsAndReversal) {
  Recording log = log_with({channel("IMU.AccX", "m/s^2", {0, 1}), channel("RCOU.C5", "1", {1400, 1100, 2000})});
  log.parameters = {{"SERVO5_FUNCTION", 19},
                    {"SERVO5_MIN", 1100},
                    {"SERVO5_TRIM", 1400},
                    {"SERVO5_MAX", 2000},
                    {"SERVO5_REVERSED", 1}};
  const MappedRecording mapped = map(log, "", {.elevator = 0.4, .known = true});
  EXPECT_THAT(mapped.recording.at("elevator").value,
              ElementsAre(DoubleNear(0.0, 1e-15), DoubleNear(0.4, 1e-15), DoubleNear(-0.4, 1e-15)));
}

TEST(ArduPilotMap, PassesOverASensorThatNeverChanges) {
  const MappedRecording mapped =
      map(log_with({channel("IMU.AccX", "m/s^2", {0, 1}), channel("ARSP.Airspeed", "m/s", {0, 0}),
                    channel("CTUN.As", "m/s", {14, 15})}));
  EXPECT_THAT(mapped.recording.at("airspeed").value, ElementsAre(14, 15));
  EXPECT_THAT(mapped.notes, ::testing::Contains(HasSubstr("ARSP.Airspeed is 0 throughout")));
}

TEST(ArduPilotMap, DoesNotTakeTheEstimateAoaForAVane) {
  const MappedRecording mapped =
      map(log_with({channel("IMU.AccX", "m/s^2", {0, 1}), channel("AOA.AOA", "deg", {1, 2})}));
  EXPECT_FALSE(mapped.recording.has("alpha"));
  EXPECT_THAT(mapped.notes, ::testing::Contains(HasSubstr("not a vane")));
}

// A 30 deg roll to the right: q = (cos 15 deg, sin 15 deg, 0, 0).
TEST(Px4Map, TurnsQuaternionsIntoEulerAngles) {
  const double c = std::cos(15.0 * kDegree);
  const double s = std::sin(15.0 * kDegree);
  const MappedRecording mapped =
      map(log_with({channel("vehicle_attitude.q[0]", "1", {1, c}), channel("vehicle_attitude.q[1]", "1", {0, s}),
                    channel("vehicle_attitude.q[2]", "1", {0, 0}), channel("vehicle_attitude.q[3]", "1", {0, 0})}));
  EXPECT_EQ(mapped.log_kind, "PX4");
  EXPECT_THAT(mapped.recording.at("roll").value, ElementsAre(0.0, DoubleNear(30.0 * kDegree, 1e-14)));
  EXPECT_THAT(mapped.recording.at("pitch").value, ElementsAre(0.0, DoubleNear(0.0, 1e-14)));
}

TEST(Px4Map, ReadsIntegerPositionsAndOldRates) {
  const MappedRecording mapped = map(
      log_with({channel("vehicle_attitude.q[0]", "1", {1, 1}), channel("vehicle_attitude.rollspeed", "1", {0.1, 0.2}),
                channel("vehicle_gps_position.lat", "1", {452206015, 452206016})}));
  EXPECT_THAT(mapped.recording.at("gyro_x").value, ElementsAre(0.1, 0.2));
  EXPECT_NEAR(mapped.recording.at("lat").value[0], 45.2206015 * kDegree, 1e-12);
}

}  // namespace
}  // namespace veridyn::aircraft
