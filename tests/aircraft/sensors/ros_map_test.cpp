#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/sensors/mapped_log.hpp"
#include "tests/support/ros_recording.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::map;
using numerics::R_body_from_ned;
using ::testing::ElementsAre;
using veridyn::testing::RosRecording;

/// East, north, up from north, east, down; its own inverse. Forward, left, up from forward, right, down likewise.
const Eigen::Matrix3d kEnuNed = (Eigen::Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished();
const Eigen::Matrix3d kFluFrd = Eigen::Vector3d(1, -1, -1).asDiagonal();

struct Moment {
  double roll, pitch, yaw;
  Eigen::Vector3d force, rates, velocity_ned;
};

// A climbing turn to the right, written in the aircraft's own frames and turned into those of ROS by matrices.
const std::vector<Moment> kFlight{{0.5, 0.1, 1.0, {0.5, 0.3, -11.0}, {0.02, 0.1, 0.2}, {10.0, 15.0, -2.0}},
                                  {0.4, 0.2, -3.0, {0.6, -0.3, -10.0}, {-0.1, 0.2, 0.1}, {-17.0, -2.0, 1.0}}};

Eigen::Matrix3d R_enu_from_flu(const Moment& m) {
  return kEnuNed * R_body_from_ned(m.roll, m.pitch, m.yaw).transpose() * kFluFrd;
}

template <typename Part>
auto parts(Part part) {
  std::vector<decltype(part(kFlight[0]))> all;
  for (const Moment& m : kFlight) all.push_back(part(m));
  return all;
}

RosRecording flight_with_imu() {
  RosRecording made(2);
  made.topic("imu", "sensor_msgs/msg/Imu", "base_link");
  made.vectors(".linear_acceleration", "m/s^2",
               parts([](const Moment& m) { return Eigen::Vector3d(kFluFrd * m.force); }));
  made.vectors(".angular_velocity", "rad/s", parts([](const Moment& m) { return Eigen::Vector3d(kFluFrd * m.rates); }));
  made.attitudes(".orientation", parts(R_enu_from_flu));
  return made;
}

void expect_flight(const MappedRecording& mapped) {
  const auto value = [&](const char* name, std::size_t k) { return mapped.recording.at(name).value[k]; };
  for (std::size_t k = 0; k < kFlight.size(); ++k) {
    const Moment& m = kFlight[k];
    EXPECT_NEAR(value("roll", k), m.roll, 1e-12);
    EXPECT_NEAR(value("pitch", k), m.pitch, 1e-12);
    EXPECT_NEAR(value("yaw", k), m.yaw, 1e-12);
    EXPECT_NEAR(value("vel_north", k), m.velocity_ned(0), 1e-12);
    EXPECT_NEAR(value("vel_east", k), m.velocity_ned(1), 1e-12);
    EXPECT_NEAR(value("vel_down", k), m.velocity_ned(2), 1e-12);
    for (Eigen::Index i = 0; i < 3; ++i) {
      EXPECT_NEAR(value(std::array{"accel_x", "accel_y", "accel_z"}[static_cast<std::size_t>(i)], k), m.force(i),
                  1e-12);
      EXPECT_NEAR(value(std::array{"gyro_x", "gyro_y", "gyro_z"}[static_cast<std::size_t>(i)], k), m.rates(i), 1e-12);
    }
  }
}

TEST(RosMap, TurnsImuAndReceiverIntoTheAircraftsFrames) {
  RosRecording made = flight_with_imu();
  made.topic("gps_vel", "geometry_msgs/msg/TwistStamped", "gps");
  made.vectors(".twist.linear", "m/s",
               parts([](const Moment& m) { return Eigen::Vector3d(kEnuNed * m.velocity_ned); }));
  const MappedRecording mapped = map(made.log());
  EXPECT_EQ(mapped.log_kind, "ROS");
  EXPECT_EQ(mapped.recording.frame, Frame::kFrd);
  expect_flight(mapped);
}

TEST(RosMap, TurnsAnOdometryIntoTheAircraftsFrames) {
  RosRecording made = flight_with_imu();
  made.topic("odom", "nav_msgs/msg/Odometry", "map", "base_link");
  made.attitudes(".pose.pose.orientation", parts(R_enu_from_flu));
  made.vectors(".twist.twist.linear", "m/s", parts([](const Moment& m) {
                 return Eigen::Vector3d(kFluFrd * R_body_from_ned(m.roll, m.pitch, m.yaw) * m.velocity_ned);
               }));
  const MappedRecording mapped = map(made.log());
  expect_flight(mapped);
  EXPECT_EQ(mapped.origins.back().note, "of an estimator, in its frame map");
}

TEST(RosMap, TakesPositionAirspeedAndPressures) {
  RosRecording made(2);
  made.topic("fix", "sensor_msgs/msg/NavSatFix").channel(".latitude", "rad", {0.8, 0.81});
  made.channel(".longitude", "rad", {0.1, 0.11}).channel(".altitude", "m", {500, 501});
  made.topic("hud", "mavros_msgs/msg/VfrHud")
      .channel(".airspeed", "m/s", {20, 21})
      .channel(".throttle", "1", {0.5, 0.6});
  made.topic("static_pressure", "sensor_msgs/msg/FluidPressure").channel(".fluid_pressure", "Pa", {95000, 95010});
  made.topic("diff_pressure", "sensor_msgs/msg/FluidPressure").channel(".fluid_pressure", "Pa", {200, 210});
  const MappedRecording mapped = map(made.log());
  EXPECT_THAT(mapped.recording.at("lat").value, ElementsAre(0.8, 0.81));
  EXPECT_THAT(mapped.recording.at("alt").value, ElementsAre(500.0, 501.0));
  EXPECT_THAT(mapped.recording.at("airspeed").value, ElementsAre(20.0, 21.0));
  EXPECT_THAT(mapped.recording.at("throttle").value, ElementsAre(0.5, 0.6));
  EXPECT_THAT(mapped.recording.at("static_pressure").value, ElementsAre(95000.0, 95010.0));
  EXPECT_THAT(mapped.recording.at("dynamic_pressure").value, ElementsAre(200.0, 210.0));
}

TEST(RosMap, LeavesWhatTheStudyMapsAsItWasRecorded) {
  const MappedRecording mapped = map(flight_with_imu().log(),
                                     "accel_y = { channel = 'imu.linear_acceleration.y', scale = -1 }\n"
                                     "gyro_x = 'imu.angular_velocity.x'\n");
  EXPECT_NEAR(mapped.recording.at("accel_y").value[0], kFlight[0].force(1), 1e-12);
  EXPECT_NEAR(mapped.recording.at("gyro_x").value[0], kFlight[0].rates(0), 1e-12);
}

}  // namespace
}  // namespace veridyn::aircraft
