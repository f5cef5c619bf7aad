#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/sensors/mapped_log.hpp"
#include "tests/support/tlog_writer.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/io/mavlink/tlog.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::channel;
using aircraft::testing::log_with;
using aircraft::testing::map;
using ::testing::Contains;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(MavlinkMap, GivesTheChannelsOfATelemetryLogTheirStandardNames) {
  const MappedRecording mapped = map(io::to_recording(io::read_tlog(veridyn::testing::small_tlog(), "flight.tlog")), "",
                                     {.elevator = 0.4, .aileron = 0.35, .rudder = 0.35, .known = true});
  EXPECT_EQ(mapped.log_kind, "MAVLink");
  const auto value = [&](const char* name, std::size_t i) { return mapped.recording.at(name).value[i]; };
  EXPECT_NEAR(value("accel_x", 30), 0.3 * kGravity, 1e-9);
  EXPECT_NEAR(value("gyro_y", 10), 0.1, 1e-12) << "RAW_IMU, not the filter's";
  EXPECT_NEAR(value("roll", 5), 0.1 * std::sin(1.5), 1e-7);
  EXPECT_NEAR(value("vel_east", 7), -2.57, 1e-9);
  EXPECT_NEAR(value("alt", 0), 505.0, 1e-9) << "of GPS";
  EXPECT_NEAR(value("dynamic_pressure", 5), 0.5 * 1.225 * std::pow(20.0 + std::sin(1.5), 2), 1e-3)
      << "of the airspeed that the autopilot calibrated, not of the sensor's pressure";
  EXPECT_EQ(mapped.recording.find("airspeed"), nullptr);
  EXPECT_EQ(mapped.recording.find("aileron"), nullptr) << "no parameter says which servo it is";
  // SERVO2_FUNCTION = 19; 1550 us of 1500 to 2000.
  EXPECT_NEAR(value("elevator", 10), 0.4 * 0.1, 1e-9);
}

TEST(MavlinkMap, TakesSpeedAndCourseAndTheQuaternionWhereThereIsNothingElse) {
  const double c = std::cos(15.0 * kDegree), s = std::sin(15.0 * kDegree);
  const MappedRecording mapped =
      map(log_with({channel("ATTITUDE_QUATERNION.q1", "1", {1, c}), channel("ATTITUDE_QUATERNION.q2", "1", {0, s}),
                    channel("ATTITUDE_QUATERNION.q3", "1", {0, 0}), channel("ATTITUDE_QUATERNION.q4", "1", {0, 0}),
                    channel("GPS_RAW_INT.vel", "m/s", {10, 20}), channel("GPS_RAW_INT.cog", "rad", {0.5 * kPi, kPi}),
                    channel("ACTUATOR_CONTROL_TARGET.controls[1]", "1", {0.0, 0.5}),
                    channel("SERVO_OUTPUT_RAW.servo1_raw", "s", {0.0015, 0.0016})}));
  EXPECT_THAT(mapped.recording.at("roll").value, ElementsAre(0.0, DoubleNear(30.0 * kDegree, 1e-14)));
  EXPECT_THAT(mapped.recording.at("vel_north").value, ElementsAre(DoubleNear(0.0, 1e-12), DoubleNear(-20.0, 1e-12)));
  EXPECT_THAT(mapped.recording.at("vel_east").value, ElementsAre(DoubleNear(10.0, 1e-12), DoubleNear(0.0, 1e-12)));
  EXPECT_EQ(mapped.recording.find("vel_down"), nullptr);
  EXPECT_THAT(mapped.recording.at("elevator").value, ElementsAre(0.0, DoubleNear(-0.175, 1e-12)));
}

TEST(MavlinkMap, AssumesNoServoOfALogThatDoesNotSayWhatTheyMove) {
  const MappedRecording mapped = map(log_with({channel("ATTITUDE.roll", "rad", {0.0, 0.1}),
                                               channel("SERVO_OUTPUT_RAW.servo1_raw", "s", {0.0015, 0.0016}),
                                               channel("SERVO_OUTPUT_RAW.servo2_raw", "s", {0.0015, 0.0016})}));
  EXPECT_EQ(mapped.recording.find("elevator"), nullptr);
  EXPECT_THAT(mapped.notes, Contains(HasSubstr("no SERVOn_FUNCTION")));
}

}  // namespace
}  // namespace veridyn::aircraft
