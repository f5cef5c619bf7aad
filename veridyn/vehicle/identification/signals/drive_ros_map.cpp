// The channels of a drive that was recorded by ROS.
#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/recording/ros_motion.hpp"
#include "veridyn/recording/ros_topics.hpp"
#include "veridyn/vehicle/identification/signals/drive_maps.hpp"

namespace veridyn::vehicle::internal {
namespace {

using recording::RosMotion;
using recording::RosTopic;
using recording::RosTopics;
using recording::RosVector;

/// Below it a receiver's velocity has no direction [m/s].
constexpr double kStandingSpeed_mps = 0.5;
/// Mean radius of the earth [m].
constexpr double kEarthRadius_m = 6'371'008.8;

class RosDriveMap {
 public:
  RosDriveMap(const Recording& log, recording::MappedRecording& mapped)
      : topics_(log), mapped_(mapped), motion_(recording::ros_motion(log)) {}

  void run() {
    put_axes(motion_.specific_force, "m/s^2", {"accel_x", "accel_y", "accel_z"});
    put_axes(motion_.rates, "rad/s", {"gyro_x", "gyro_y", "gyro_z"});
    if (motion_.attitude) {
      const recording::RosAngles& a = *motion_.attitude;
      put("roll", "rad", a.time, a.roll, a.source, a.note);
      put("pitch", "rad", a.time, a.pitch, a.source, a.note);
      put("yaw", "rad", a.time, a.yaw, a.source, a.note);
    }
    map_steering();
    map_speed();
    map_course();
    map_position();
    for (const std::string& note : motion_.notes) mapped_.notes.push_back(note);
  }

 private:
  void put(const char* channel, const char* unit, const TimeBase& time, std::vector<double> values,
           const std::string& source, const std::string& note) {
    // What stands still is not measured: the roll of a planar odometry.
    if (recording::changes(values)) put_mapped(mapped_, channel, unit, time, std::move(values), source, note);
  }

  void put_axes(const std::optional<RosVector>& from, const char* unit, std::array<const char*, 3> channels) {
    if (!from) return;
    for (std::size_t i = 0; i < 3; ++i)
      put(channels[i], unit, from->time, from->value[i], fmt::format("{}.{}", from->source, "xyz"[i]), from->note);
  }

  void put_channel(const RosTopic& topic, std::string_view field, const char* channel, const char* unit,
                   const char* note) {
    const Channel* const raw = topics_.alive_channel(topic, field);
    if (raw == nullptr) return;
    put(channel, unit, raw->time, recording::in_si(*raw, 0.0, 1.0, unit), raw->name, note);
  }

  void note(std::string text) { mapped_.notes.push_back(std::move(text)); }

  /// What was measured, else what was commanded, if that is one topic.
  void map_steering() {
    const auto reports = topics_.alive(
        {"autoware_vehicle_msgs/SteeringReport", "autoware_auto_vehicle_msgs/SteeringReport"}, ".steering_tire_angle");
    if (!reports.empty())
      return put_channel(reports.front(), ".steering_tire_angle", "steer", "rad", "of the road wheels");
    std::vector<std::pair<RosTopic, std::string>> commands;
    for (const RosTopic& topic : topics_.alive({"ackermann_msgs/AckermannDriveStamped"}, ".drive.steering_angle"))
      commands.emplace_back(topic, ".drive.steering_angle");
    for (const RosTopic& topic : topics_.alive({"ackermann_msgs/AckermannDrive"}, ".steering_angle"))
      commands.emplace_back(topic, ".steering_angle");
    if (commands.size() == 1) {
      put_channel(commands.front().first, commands.front().second, "steer", "rad",
                  "commanded: the wheels follow later, and the servo's time is part of the result");
    } else if (!commands.empty()) {
      std::string names;
      for (const auto& [topic, field] : commands)
        names += fmt::format("{}\"{}{}\"", names.empty() ? "" : " or ", topic.name, field);
      note(fmt::format("several topics command the steering: say which one moved it, steer = {} in [data.map]", names));
    }
  }

  void map_speed() {
    for (const RosTopic& topic :
         topics_.alive({"autoware_vehicle_msgs/VelocityReport", "autoware_auto_vehicle_msgs/VelocityReport"},
                       ".longitudinal_velocity")) {
      put_channel(topic, ".longitudinal_velocity", "speed", "m/s", "of the wheels");
      if (!mapped_.recording.has("gyro_z")) put_channel(topic, ".heading_rate", "yaw_rate", "rad/s", "");
    }
    if (motion_.velocity_body) {
      const RosVector& v = *motion_.velocity_body;
      put("speed", "m/s", v.time, v.value[0], v.source + ".x", v.note);
      if (recording::changes(v.value[1]) && !mapped_.recording.has("lateral_velocity"))
        note(
            fmt::format("{}.y may be lateral_velocity, but an estimator may have made it up: not taken; "
                        "lateral_velocity = \"{}.y\" in [data.map] takes it",
                        v.source, v.source));
    }
    if (motion_.receiver_velocity) {
      const RosVector& v = *motion_.velocity_world;
      std::vector<double> speed(v.value[0].size());
      for (std::size_t i = 0; i < speed.size(); ++i) speed[i] = std::hypot(v.value[0][i], v.value[1][i]);
      put("speed", "m/s", v.time, std::move(speed), v.source, "along its course: not the sign of reversing");
    }
  }

  void map_course() {
    if (!motion_.receiver_velocity) return;
    const RosVector& v = *motion_.velocity_world;
    std::vector<double> course(v.value[0].size());
    for (std::size_t i = 0; i < course.size(); ++i)
      course[i] = std::hypot(v.value[0][i], v.value[1][i]) > kStandingSpeed_mps
                      ? std::atan2(v.value[1][i], v.value[0][i])
                      : kNaN;
    put("course", "rad", v.time, std::move(course), v.source, "from east to the left");
  }

  /// Positions and heading of one source agree with each other.
  void map_position() {
    if (motion_.odometry_attitude) return put_position();
    for (const RosTopic& topic : topics_.alive({"sensor_msgs/NavSatFix"}, ".latitude")) {
      const Channel& latitude = *topics_.alive_channel(topic, ".latitude");
      const Channel* const longitude = topics_.alive_channel(topic, ".longitude");
      if (longitude == nullptr || mapped_.recording.has("pos_x")) continue;
      const std::vector<double> longitudes = recording::at_stamps_of(*longitude, latitude);
      std::size_t first = 0;
      while (first < latitude.size() && !(std::isfinite(latitude.value[first]) && std::isfinite(longitudes[first])))
        ++first;
      if (first == latitude.size()) continue;
      const double lat = latitude.value[first], lon = longitudes[first], east = std::cos(lat);
      std::vector<double> x, y;
      for (std::size_t i = 0; i < latitude.size(); ++i) {
        x.push_back(kEarthRadius_m * east * (longitudes[i] - lon));
        y.push_back(kEarthRadius_m * (latitude.value[i] - lat));
      }
      put("pos_x", "m", latitude.time, std::move(x), longitude->name, "east of the first fix");
      put("pos_y", "m", latitude.time, std::move(y), latitude.name, "north of the first fix");
    }
    put_position();
  }

  void put_position() {
    if (!motion_.position || mapped_.recording.has("pos_x") || mapped_.recording.has("pos_y")) return;
    const RosVector& p = *motion_.position;
    put("pos_x", "m", p.time, p.value[0], p.source + ".x", p.note);
    put("pos_y", "m", p.time, p.value[1], p.source + ".y", p.note);
  }

  RosTopics topics_;
  recording::MappedRecording& mapped_;
  RosMotion motion_;
};

}  // namespace

recording::MappedRecording with_ros_channels(recording::MappedRecording mapped, const Recording& log) {
  if (!recording::is_ros(log)) return mapped;
  mapped.log_kind = "ROS";
  RosDriveMap(log, mapped).run();
  return mapped;
}

}  // namespace veridyn::vehicle::internal
