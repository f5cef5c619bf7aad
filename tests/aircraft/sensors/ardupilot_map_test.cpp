#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace veridyn::aircraft
