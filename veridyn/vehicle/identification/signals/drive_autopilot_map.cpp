// The channels of a drive that a rover's autopilot recorded.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "veridyn/recording/ros_topics.hpp"
#include "veridyn/vehicle/identification/signals/drive_maps.hpp"

namespace veridyn::vehicle::internal {
namespace {

struct Rule {
  const char* channel;
  const char* unit;
  const char* source;
  const char* note;
};

/// Messages of common.xml, those that come oftenest or are least processed first; x forward, y right, z down.
constexpr Rule kMavlink[] = {
    {"accel_x", "m/s^2", "HIGHRES_IMU.xacc", ""},
    {"accel_y", "m/s^2", "HIGHRES_IMU.yacc", ""},
    {"accel_z", "m/s^2", "HIGHRES_IMU.zacc", ""},
    {"gyro_x", "rad/s", "HIGHRES_IMU.xgyro", ""},
    {"gyro_y", "rad/s", "HIGHRES_IMU.ygyro", ""},
    {"gyro_z", "rad/s", "HIGHRES_IMU.zgyro", ""},
    {"accel_x", "m/s^2", "SCALED_IMU.xacc", "in steps of 0.001 g"},
    {"accel_y", "m/s^2", "SCALED_IMU.yacc", "in steps of 0.001 g"},
    {"accel_z", "m/s^2", "SCALED_IMU.zacc", "in steps of 0.001 g"},
    {"gyro_x", "rad/s", "SCALED_IMU.xgyro", "in steps of 0.06 deg/s"},
    {"gyro_y", "rad/s", "SCALED_IMU.ygyro", "in steps of 0.06 deg/s"},
    {"gyro_z", "rad/s", "SCALED_IMU.zgyro", "in steps of 0.06 deg/s"},
    {"accel_x", "m/s^2", "RAW_IMU.xacc", "as ArduPilot fills it: thousandths of g"},
    {"accel_y", "m/s^2", "RAW_IMU.yacc", "as ArduPilot fills it: thousandths of g"},
    {"accel_z", "m/s^2", "RAW_IMU.zacc", "as ArduPilot fills it: thousandths of g"},
    {"gyro_x", "rad/s", "RAW_IMU.xgyro", "as ArduPilot fills it: mrad/s"},
    {"gyro_y", "rad/s", "RAW_IMU.ygyro", "as ArduPilot fills it: mrad/s"},
    {"gyro_z", "rad/s", "RAW_IMU.zgyro", "as ArduPilot fills it: mrad/s"},
    {"gyro_x", "rad/s", "ATTITUDE.rollspeed", "autopilot's filter"},
    {"gyro_y", "rad/s", "ATTITUDE.pitchspeed", "autopilot's filter"},
    {"gyro_z", "rad/s", "ATTITUDE.yawspeed", "autopilot's filter"},
    {"roll", "rad", "ATTITUDE.roll", "autopilot's filter"},
    {"pitch", "rad", "ATTITUDE.pitch", "autopilot's filter"},
    {"yaw", "rad", "ATTITUDE.yaw", "autopilot's filter"},
    {"course", "rad", "GPS_RAW_INT.cog", "of the receiver"},
    {"pos_x", "m", "LOCAL_POSITION_NED.x", "autopilot's filter"},
    {"pos_y", "m", "LOCAL_POSITION_NED.y", "autopilot's filter"},
};

class AutopilotDriveMap {
 public:
  AutopilotDriveMap(const Recording& log, recording::MappedRecording& mapped) : log_(log), mapped_(mapped) {}

  void run() {
    for (const Rule& rule : kMavlink) {
      const Channel* const raw = alive(rule.source);
      if (raw != nullptr)
        put(rule.channel, rule.unit, raw->time, recording::in_si(*raw, 0.0, 1.0, rule.unit), rule.source, rule.note);
    }
    map_forward_speed("LOCAL_POSITION_NED.vx", "LOCAL_POSITION_NED.vy");
    map_forward_speed("GLOBAL_POSITION_INT.vx", "GLOBAL_POSITION_INT.vy");
    for (const char* speed : {"VFR_HUD.groundspeed", "GPS_RAW_INT.vel"})
      if (const Channel* const raw = alive(speed); raw != nullptr)
        put("speed", "m/s", raw->time, raw->value, speed, "over ground: not the sign of reversing");
    note_steering();
  }

 private:
  void put(const char* channel, const char* unit, const TimeBase& time, std::vector<double> values,
           const std::string& source, const std::string& note) {
    put_mapped(mapped_, channel, unit, time, std::move(values), source, note);
  }

  /// Where it holds numbers that change.
  [[nodiscard]] const Channel* alive(const char* name) const {
    const Channel* const channel = log_.find(name);
    return channel != nullptr && recording::changes(channel->value) ? channel : nullptr;
  }

  /// The filter's velocity along the heading: it has the sign of reversing, which a speed over ground has not.
  void map_forward_speed(const char* north_name, const char* east_name) {
    const Channel *const north = alive(north_name), *const east = alive(east_name), *const yaw = alive("ATTITUDE.yaw");
    if (north == nullptr || east == nullptr || yaw == nullptr || north->size() != east->size()) return;
    // The heading jumps by a turn, its sine and cosine do not.
    Channel sine = *yaw, cosine = *yaw;
    for (double& v : sine.value) v = std::sin(v);
    for (double& v : cosine.value) v = std::cos(v);
    const std::vector<double> s = recording::interpolated(sine, north->times()),
                              c = recording::interpolated(cosine, north->times());
    std::vector<double> speed(north->size());
    for (std::size_t i = 0; i < speed.size(); ++i)
      speed[i] = (c[i] * north->value[i] + s[i] * east->value[i]) / std::hypot(s[i], c[i]);
    put("speed", "m/s", north->time, std::move(speed), fmt::format("{}, {}, ATTITUDE.yaw", north_name, east_name),
        "autopilot's filter, along the heading");
  }

  /// Which output steers is known, how far the wheels turn by it is not.
  void note_steering() {
    if (mapped_.recording.has("steer") || mapped_.recording.has("steering_wheel")) return;
    constexpr int kGroundSteering = 26, kOutputs = 16;
    for (int output = 1; output <= kOutputs; ++output) {
      const auto function = log_.parameters.find(fmt::format("SERVO{}_FUNCTION", output));
      if (function == log_.parameters.end() || static_cast<int>(function->second) != kGroundSteering) continue;
      const std::string channel = fmt::format("SERVO_OUTPUT_RAW.servo{}_raw", output);
      if (alive(channel.c_str()) == nullptr) continue;
      const auto trim = log_.parameters.find(fmt::format("SERVO{}_TRIM", output));
      mapped_.notes.push_back(fmt::format(
          "output {} steers (SERVO{}_FUNCTION = 26), by pulses: steer = {{ channel = \"{}\", zero = {:g}, scale = S, "
          "unit = \"rad\" }} in [data.map] takes it, S the angle of the road wheels per microsecond, positive to the "
          "right",
          output, output, channel, trim == log_.parameters.end() ? 1500.0 : trim->second));
      return;
    }
  }

  const Recording& log_;
  recording::MappedRecording& mapped_;
};

}  // namespace

recording::MappedRecording with_autopilot_channels(recording::MappedRecording mapped, const Recording& log) {
  bool mavlink = false;
  for (const char* name : {"ATTITUDE.yaw", "HIGHRES_IMU.xacc", "GLOBAL_POSITION_INT.lat"})
    mavlink = mavlink || log.has(name);
  if (!mavlink) return mapped;
  mapped.log_kind = "MAVLink";
  AutopilotDriveMap(log, mapped).run();
  return mapped;
}

}  // namespace veridyn::vehicle::internal
