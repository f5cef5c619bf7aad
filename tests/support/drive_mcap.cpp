#include "tests/support/drive_mcap.hpp"

#include <cmath>
#include <cstdint>

#include "tests/support/ros_writer.hpp"

namespace veridyn::test {

using testing::MessageWriter;

std::string as_mcap(const Recording& drive) {
  testing::McapWriter log;
  log.schema(1, "sensor_msgs/msg/Imu", "ros2msg", testing::imu_definition());
  log.schema(2, "autoware_vehicle_msgs/msg/VelocityReport", "", "");
  log.schema(3, "autoware_vehicle_msgs/msg/SteeringReport", "ros2idl", "module autoware_vehicle_msgs { };");
  log.channel(1, 1, "/sensing/imu");
  log.channel(2, 2, "/vehicle/status/velocity_status");
  log.channel(3, 3, "/vehicle/status/steering_status");
  const auto ns = [](double t) { return testing::kRosBegin_ns + static_cast<std::int64_t>(std::llround(1e9 * t)); };
  const Channel &accel = drive.at("accel_y"), &rate = drive.at("yaw_rate");
  log.begin_chunk();
  for (std::size_t i = 0; i < rate.size(); ++i)
    log.message(1, ns(rate.times()[i]) + 1000,
                testing::imu_message(ns(rate.times()[i]), 0.0, {0, 0, rate.value[i]}, {0, accel.value[i], 9.81}));
  for (std::size_t i = 0; i < drive.at("speed").size(); ++i) {
    const std::int64_t t = ns(drive.at("speed").times()[i]);
    MessageWriter m;
    m.header(t, "base_link").numbers(static_cast<float>(drive.at("speed").value[i]), 0.0F, 0.0F);
    log.message(2, t + 1000, m.bytes());
  }
  for (std::size_t i = 0; i < drive.at("steer").size(); ++i) {
    const std::int64_t t = ns(drive.at("steer").times()[i]);
    MessageWriter m;
    m.numbers(static_cast<std::int32_t>(t / 1'000'000'000), static_cast<std::uint32_t>(t % 1'000'000'000));
    log.message(3, t + 1000, m.number(static_cast<float>(drive.at("steer").value[i])).bytes());
  }
  log.end_chunk("zstd");
  log.finish();
  return log.bytes();
}

std::string small_drive_mcap() { return testing::small_mcap(); }

}  // namespace veridyn::test
