#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/aircraft/sensors/mapped_log.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::channel;
using aircraft::testing::log_with;
using aircraft::testing::map;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

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

/// Two servos with full throws of 500 us about 1500 us, of these functions.
Recording two_servos(int first, int second, std::vector<double> one, std::vector<double> other) {
  Recording log = log_with({channel("IMU.AccX", "m/s^2", {0, 1}), channel("RCOU.C1", "1", std::move(one)),
                            channel("RCOU.C2", "1", std::move(other)), channel("RCOU.C4", "1", {1500, 1600, 1700})});
  log.parameters = {{"SERVO1_FUNCTION", first}, {"SERVO2_FUNCTION", second}, {"SERVO1_MIN", 1000},
                    {"SERVO2_MIN", 1000},       {"SERVO1_MAX", 2000},        {"SERVO2_MAX", 2000}};
  return log;
}

// ArduPlane mixes left = elevator - aileron, right = elevator + aileron.
TEST(ArduPilotMap, TakesElevonsApart) {
  const MappedRecording mapped = map(two_servos(77, 78, {1500, 1400, 1600}, {1500, 1600, 1700}), "",
                                     {.elevator = 0.4, .aileron = 0.5, .known = true});
  EXPECT_THAT(mapped.recording.at("elevator").value,
              ElementsAre(DoubleNear(0.0, 1e-15), DoubleNear(0.0, 1e-15), DoubleNear(0.4 * 0.3, 1e-15)));
  EXPECT_THAT(mapped.recording.at("aileron").value,
              ElementsAre(DoubleNear(0.0, 1e-15), DoubleNear(0.5 * 0.2, 1e-15), DoubleNear(0.5 * 0.1, 1e-15)));
  // The log says what its servos do: the fourth is no rudder.
  EXPECT_FALSE(mapped.recording.has("rudder"));
}

// ArduPlane mixes left = elevator + rudder, right = elevator - rudder.
TEST(ArduPilotMap, TakesAVTailApart) {
  const MappedRecording mapped = map(two_servos(79, 80, {1500, 1600, 1700}, {1500, 1400, 1600}), "",
                                     {.elevator = 0.4, .rudder = 0.5, .known = true});
  EXPECT_THAT(mapped.recording.at("elevator").value,
              ElementsAre(DoubleNear(0.0, 1e-15), DoubleNear(0.0, 1e-15), DoubleNear(0.4 * 0.3, 1e-15)));
  EXPECT_THAT(mapped.recording.at("rudder").value,
              ElementsAre(DoubleNear(0.0, 1e-15), DoubleNear(0.5 * 0.2, 1e-15), DoubleNear(0.5 * 0.1, 1e-15)));
}

TEST(ArduPilotMap, NeedsBothElevons) {
  const MappedRecording mapped = map(two_servos(77, 0, {1500, 1400, 1600}, {1500, 1600, 1700}));
  EXPECT_FALSE(mapped.recording.has("elevator"));
  EXPECT_THAT(mapped.notes, ::testing::Contains(HasSubstr("only one of the elevons is recorded")));
}

TEST(ArduPilotMap, TakesTheMeanOfTwoServosOfOneFunction) {
  const MappedRecording mapped =
      map(two_servos(4, 4, {1500, 1600, 1700}, {1500, 1700, 1700}), "", {.aileron = 0.5, .known = true});
  EXPECT_THAT(mapped.recording.at("aileron").value,
              ElementsAre(DoubleNear(0.0, 1e-15), DoubleNear(0.15, 1e-15), DoubleNear(0.2, 1e-15)));
  EXPECT_EQ(mapped.origins.back().source, "RCOU.C1, RCOU.C2");
}

TEST(ArduPilotMap, TakesTheVelocityOfTheAutopilotsFilterWhereGpsHasNone) {
  const std::vector<Channel> filter{channel("XKF1.VN", "m/s", {1, 2}), channel("XKF1.VE", "m/s", {3, 4}),
                                    channel("XKF1.VD", "m/s", {5, 6})};
  EXPECT_THAT(map(log_with(filter)).recording.at("vel_east").value, ElementsAre(3, 4));
  std::vector<Channel> both = filter;
  both.push_back(channel("GPS.Spd", "m/s", {10, 20}));
  both.push_back(channel("GPS.GCrs", "1", {0, 0.001}));
  EXPECT_THAT(map(log_with(both)).recording.at("vel_north").value,
              ElementsAre(DoubleNear(10, 1e-6), DoubleNear(20, 1e-6)));
}

// Four samples of the filter for two of GPS.
TEST(ArduPilotMap, TakesTheVelocityOfTheAutopilotsFilterWhereItIsFaster) {
  const auto slow = [](std::string name, std::vector<double> value) {
    return make_channel(std::move(name), "1", make_time_base({0.0, 0.2}), std::move(value));
  };
  const MappedRecording mapped =
      map(log_with({channel("XKF1.VN", "m/s", {1, 2, 3}), channel("XKF1.VE", "m/s", {3, 4, 5}),
                    channel("XKF1.VD", "m/s", {5, 6, 7}), slow("GPS.Spd", {10, 20}), slow("GPS.GCrs", {0, 0.001})}));
  EXPECT_THAT(mapped.recording.at("vel_north").value, ElementsAre(1, 2, 3));
  const auto& origin = *std::ranges::find(mapped.origins, "vel_north", &recording::ChannelOrigin::channel);
  EXPECT_EQ(origin.note, "autopilot's EKF3, which is faster than GPS (5 Hz)");
  EXPECT_EQ(mapped.left.front().source, "GPS.Spd");
}

TEST(ArduPilotMap, PassesOverASensorThatNeverChanges) {
  const MappedRecording mapped =
      map(log_with({channel("IMU.AccX", "m/s^2", {0, 1}), channel("ARSP.Airspeed", "m/s", {0, 0}),
                    channel("CTUN.As", "m/s", {14, 15})}));
  EXPECT_THAT(mapped.recording.at("dynamic_pressure").value,
              ElementsAre(DoubleNear(0.5 * 1.225 * 196.0, 1e-9), DoubleNear(0.5 * 1.225 * 225.0, 1e-9)));
  EXPECT_THAT(mapped.notes, ::testing::Contains(HasSubstr("ARSP.Airspeed is 0 throughout")));
}

TEST(ArduPilotMap, DoesNotTakeTheEstimateAoaForAVane) {
  const MappedRecording mapped =
      map(log_with({channel("IMU.AccX", "m/s^2", {0, 1}), channel("AOA.AOA", "deg", {1, 2})}));
  EXPECT_FALSE(mapped.recording.has("alpha"));
  EXPECT_THAT(mapped.notes, ::testing::Contains(HasSubstr("not a vane")));
}

}  // namespace
}  // namespace veridyn::aircraft
