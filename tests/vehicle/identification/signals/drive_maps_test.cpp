#include "veridyn/vehicle/identification/signals/drive_maps.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/drive_mcap.hpp"
#include "tests/support/ros_recording.hpp"
#include "tests/support/ros_writer.hpp"
#include "tests/support/synthetic_logs.hpp"
#include "tests/support/tlog_writer.hpp"
#include "tests/vehicle/changed_drive.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/io/mavlink/tlog.hpp"
#include "veridyn/io/ros/mcap.hpp"
#include "veridyn/vehicle/identification/signals/drive_log.hpp"

namespace veridyn::vehicle {
namespace {

using ::testing::Contains;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using veridyn::testing::pack;
using veridyn::testing::RosRecording;

recording::MappedRecording mapped_drive(const Recording& log) {
  return map_drive_channels(log, StudyTable("data.map"));
}

TEST(RosDriveMap, MakesADriveOfImuOdometryAndAckermann) {
  const recording::MappedRecording made =
      mapped_drive(io::to_recording(io::read_mcap(veridyn::testing::small_mcap(), "drive.mcap")));
  EXPECT_EQ(made.log_kind, "ROS");
  EXPECT_EQ(made.recording.frame, Frame::kFlu);
  // Of the writer: a turn to the left is positive, as in ISO 8855.
  const auto value = [&](const char* name, std::size_t k) { return made.recording.at(name).value[k]; };
  const double t = 0.02 * 40, rate = 0.3 * std::sin(2.0 * t);
  EXPECT_NEAR(value("gyro_z", 40), rate, 1e-12);
  EXPECT_NEAR(value("accel_y", 40), 10.0 * rate, 1e-12);
  EXPECT_NEAR(value("accel_z", 40), 9.811, 1e-12);
  EXPECT_NEAR(value("speed", 40), 10.0 + t, 1e-12);
  EXPECT_NEAR(value("yaw", 40), 0.15 * (1.0 - std::cos(2.0 * t)), 1e-12);
  EXPECT_NEAR(value("pos_x", 40), 10.0 * t, 1e-12);
  EXPECT_NEAR(value("steer", 20), 0.1 * rate, 1e-7);
  EXPECT_NEAR(made.recording.at("steer").times()[20], 0.8 - 0.003, 1e-9) << "by its stamp";
  EXPECT_FALSE(made.recording.has("lateral_velocity"));
}

// The fit sees the same drive: signs, axes, units and times.
TEST(RosDriveMap, GivesASimulatedDriveBackThatWasRecordedByRos) {
  const Recording drive = testing::recorded();
  ASSERT_EQ(drive.at("accel_y").size(), drive.at("yaw_rate").size());
  const recording::MappedRecording made =
      mapped_drive(io::to_recording(io::read_mcap(test::as_mcap(drive), "drive.mcap")));
  const double begin = drive.at("yaw_rate").times().front();
  for (const auto& [channel, source] : {std::pair("gyro_z", "yaw_rate"), std::pair("accel_y", "accel_y"),
                                        std::pair("speed", "speed"), std::pair("steer", "steer")}) {
    const Channel &a = made.recording.at(channel), &b = drive.at(source);
    ASSERT_EQ(a.size(), b.size()) << channel;
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_NEAR(a.times()[i], b.times()[i] - begin, 2e-6) << channel;
      // float32 of the reports
      ASSERT_NEAR(a.value[i], b.value[i], 1e-6 * std::max(1.0, std::abs(b.value[i]))) << channel;
    }
  }
}

TEST(RosDriveMap, TakesNothingThatStandsStill) {
  RosRecording made(2);
  made.topic("odom", "nav_msgs/msg/Odometry", "odom", "base_link");
  made.vectors(".twist.twist.linear", "m/s", {{10, 0, 0}, {11, 0, 0}});
  made.attitudes(".pose.pose.orientation",
                 {Eigen::Matrix3d::Identity(), Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()).toRotationMatrix()});
  const recording::MappedRecording drive = mapped_drive(made.log());
  EXPECT_TRUE(drive.recording.has("yaw"));
  EXPECT_FALSE(drive.recording.has("roll")) << "a planar odometry says nothing of it";
}

TEST(RosDriveMap, PrefersWhatWasMeasuredToWhatWasCommanded) {
  RosRecording made(2);
  made.topic("cmd", "ackermann_msgs/msg/AckermannDriveStamped").channel(".drive.steering_angle", "rad", {0.3, 0.4});
  made.topic("status/steering", "autoware_vehicle_msgs/msg/SteeringReport")
      .channel(".steering_tire_angle", "rad", {0.1, 0.2});
  made.topic("status/velocity", "autoware_vehicle_msgs/msg/VelocityReport")
      .channel(".longitudinal_velocity", "m/s", {5, 6});
  made.channel(".heading_rate", "rad/s", {0.05, 0.06});
  const recording::MappedRecording drive = mapped_drive(made.log());
  EXPECT_THAT(drive.recording.at("steer").value, ElementsAre(0.1, 0.2));
  EXPECT_THAT(drive.recording.at("speed").value, ElementsAre(5.0, 6.0));
  EXPECT_THAT(drive.recording.at("yaw_rate").value, ElementsAre(0.05, 0.06));
}

TEST(RosDriveMap, DoesNotChooseBetweenCommands) {
  RosRecording made(2);
  made.topic("drive", "ackermann_msgs/msg/AckermannDriveStamped").channel(".drive.steering_angle", "rad", {0.3, 0.4});
  made.topic("teleop", "ackermann_msgs/msg/AckermannDriveStamped").channel(".drive.steering_angle", "rad", {0.1, 0.2});
  const recording::MappedRecording drive = mapped_drive(made.log());
  EXPECT_FALSE(drive.recording.has("steer"));
  EXPECT_THAT(drive.notes, Contains(HasSubstr("several topics command the steering: say which one moved it, steer = "
                                              "\"drive.drive.steering_angle\" or \"teleop.drive.steering_angle\"")));
}

TEST(RosDriveMap, MakesSpeedAndCourseOfAReceiverAndPositionsOfItsFixes) {
  RosRecording made(3);
  made.topic("fix_velocity", "geometry_msgs/msg/TwistWithCovarianceStamped", "gps");
  made.vectors(".twist.twist.linear", "m/s", {{3, 4, 0}, {0.1, 0.1, 0}, {-5, 0, 0}});
  made.topic("fix", "sensor_msgs/msg/NavSatFix").channel(".latitude", "rad", {0.8, 0.80001, 0.8});
  made.channel(".longitude", "rad", {0.1, 0.1, 0.10001});
  const recording::MappedRecording drive = mapped_drive(made.log());
  EXPECT_THAT(drive.recording.at("speed").value, ElementsAre(5.0, DoubleNear(0.1414, 1e-4), 5.0));
  const std::vector<double>& course = drive.recording.at("course").value;
  EXPECT_NEAR(course[0], std::atan2(4.0, 3.0), 1e-12);
  EXPECT_TRUE(std::isnan(course[1])) << "it stands";
  EXPECT_NEAR(course[2], kPi, 1e-12);
  // A minute of arc of latitude is a nautical mile, 1852 m, within 0.3 % on the ellipsoid.
  EXPECT_NEAR(drive.recording.at("pos_y").value[1], 1e-5 / kPi * 180.0 * 60.0 * 1852.0, 0.003 * 63.7);
  EXPECT_NEAR(drive.recording.at("pos_x").value[2], 63.71 * std::cos(0.8), 0.01);
}

TEST(RosDriveMap, SaysWhatMayBeALateralVelocity) {
  RosRecording made(2);
  made.topic("odom", "nav_msgs/msg/Odometry", "odom", "base_link")
      .vectors(".twist.twist.linear", "m/s", {{9, 0, 0}, {8, 0.5, 0}});
  const recording::MappedRecording drive = mapped_drive(made.log());
  EXPECT_THAT(drive.notes,
              Contains(HasSubstr("lateral_velocity = \"odom.twist.twist.linear.y\" in [data.map] takes it")));
}

/// A rover that goes north at 5 m/s, turns to the right, and backs up at last.
std::string rover_tlog() {
  veridyn::testing::TlogWriter log;
  const auto parameter = [&](const char* name, float value) {
    std::string id(name);
    id.resize(16, '\0');
    log.packet(0, 22, 220, pack(value, std::uint16_t{2}, std::uint16_t{0}) + id + pack(std::uint8_t{9}));
  };
  parameter("SERVO1_FUNCTION", 26.0F);
  parameter("SERVO1_TRIM", 1490.0F);
  log.packet(
      0, 0, 50,
      pack(std::uint32_t{10}, std::uint8_t{10}, std::uint8_t{3}, std::uint8_t{209}, std::uint8_t{4}, std::uint8_t{3}));
  for (int i = 0; i < 40; ++i) {
    const std::uint64_t us = 50'000ULL * static_cast<std::uint64_t>(i);
    const auto boot_ms = static_cast<std::uint32_t>(100'000 + 50 * i);
    const double yaw = 3.1 + 0.01 * i;  // passes 180 deg
    const double speed = i < 30 ? 5.0 : -2.0;
    const auto wrapped = static_cast<float>(std::remainder(yaw, 2.0 * kPi));
    log.packet(us, 30, 39, pack(boot_ms, 0.02F * static_cast<float>(i), 0.01F, wrapped, 0.0F, 0.0F, 0.2F));
    log.packet(us, 27, 144,
               pack(1000ULL * boot_ms, std::int16_t{100}, static_cast<std::int16_t>(20 * i),
                    static_cast<std::int16_t>(-1000 - i % 2), std::int16_t{1}, std::int16_t{2},
                    static_cast<std::int16_t>(200 + i), std::int16_t{0}, std::int16_t{0}, std::int16_t{0}));
    log.packet(us, 32, 185,
               pack(boot_ms, static_cast<float>(i), static_cast<float>(2 * i), 0.0F,
                    static_cast<float>(speed * std::cos(yaw)), static_cast<float>(speed * std::sin(yaw)), 0.0F));
    log.packet(us, 36, 222,
               pack(1000U * boot_ms, static_cast<std::uint16_t>(1490 + 5 * i), std::uint16_t{1500}, std::uint16_t{1700},
                    std::uint16_t{1500}, std::uint16_t{0}, std::uint16_t{0}, std::uint16_t{0}, std::uint16_t{0},
                    std::uint8_t{0}));
  }
  return log.bytes();
}

TEST(AutopilotDriveMap, MakesADriveOfARoversTelemetry) {
  const Recording log = io::to_recording(io::read_tlog(rover_tlog(), "rover.tlog"));
  EXPECT_EQ(log.information.at("vehicle"), "ground rover");
  const recording::MappedRecording made = mapped_drive(log);
  EXPECT_EQ(made.log_kind, "MAVLink");
  const auto value = [&](const char* name, std::size_t k) { return made.recording.at(name).value[k]; };
  // To the right in MAVLink is positive, here it is negative.
  EXPECT_NEAR(value("gyro_z", 10), -0.21, 1e-9);
  EXPECT_NEAR(value("accel_y", 10), -0.2 * kGravity, 1e-9);
  EXPECT_NEAR(value("accel_z", 10), kGravity, 1e-9);
  EXPECT_NEAR(value("roll", 10), 0.2, 1e-6);
  EXPECT_NEAR(std::remainder(value("yaw", 10) + 3.2, 2.0 * kPi), 0.0, 1e-6);
  EXPECT_NEAR(value("speed", 10), 5.0, 1e-4);
  EXPECT_NEAR(value("speed", 35), -2.0, 1e-4) << "backwards";
  EXPECT_NEAR(value("pos_x", 7), 7.0, 1e-9);
  EXPECT_NEAR(value("pos_y", 7), -14.0, 1e-9) << "west of north";
  EXPECT_FALSE(made.recording.has("steer"));
  EXPECT_THAT(made.notes, Contains(HasSubstr("output 1 steers (SERVO1_FUNCTION = 26), by pulses: steer = { channel = "
                                             "\"SERVO_OUTPUT_RAW.servo1_raw\", zero = 1490, scale = S")));
}

// As the note says it.
TEST(AutopilotDriveMap, TakesTheSteeringAsTheStudyMapsIt) {
  const Recording log = io::to_recording(io::read_tlog(rover_tlog(), "rover.tlog"));
  const Study study = Study::parse(
      "[map]\nsteer = { channel = \"SERVO_OUTPUT_RAW.servo1_raw\", zero = 1490, scale = 0.001, unit = \"rad\" }\n",
      "study.toml");
  const recording::MappedRecording made = map_drive_channels(log, study.root().table("map"));
  EXPECT_NEAR(made.recording.at("steer").value[10], -0.05, 1e-9) << "to the right";
}

TEST(AutopilotDriveMap, LeavesOtherRecordingsAlone) {
  Recording log;
  log.add(make_channel("YawRate", "rad/s", make_time_base({0.0, 0.1}), {0.1, 0.2}));
  EXPECT_EQ(mapped_drive(log).log_kind, "study");
}

}  // namespace
}  // namespace veridyn::vehicle
