#include <fmt/format.h>

#include <array>
#include <cmath>

#include "veridyn/aircraft/sensors/channel_rules.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft::internal {
namespace {

// Messages by the firmware's own description (libraries/AP_Logger/LogStructure.h). Units stand for logs without FMTU.
const std::vector<ChannelRule>& ardupilot_rules() {
  static const std::vector<ChannelRule> table{
      {"accel_x", "IMU.AccX", "m/s^2", ""},
      {"accel_y", "IMU.AccY", "m/s^2", ""},
      {"accel_z", "IMU.AccZ", "m/s^2", ""},
      {"gyro_x", "IMU.GyrX", "rad/s", ""},
      {"gyro_y", "IMU.GyrY", "rad/s", ""},
      {"gyro_z", "IMU.GyrZ", "rad/s", ""},
      {"accel_x", "IMU2.AccX", "m/s^2", "second IMU"},
      {"accel_y", "IMU2.AccY", "m/s^2", "second IMU"},
      {"accel_z", "IMU2.AccZ", "m/s^2", "second IMU"},
      {"gyro_x", "IMU2.GyrX", "rad/s", "second IMU"},
      {"gyro_y", "IMU2.GyrY", "rad/s", "second IMU"},
      {"gyro_z", "IMU2.GyrZ", "rad/s", "second IMU"},
      {"roll", "ATT.Roll", "deg", "autopilot's filter"},
      {"pitch", "ATT.Pitch", "deg", "autopilot's filter"},
      {"yaw", "ATT.Yaw", "deg", "autopilot's filter"},
      {"roll", "XKF1.Roll", "deg", "autopilot's EKF3"},
      {"pitch", "XKF1.Pitch", "deg", "autopilot's EKF3"},
      {"yaw", "XKF1.Yaw", "deg", "autopilot's EKF3"},
      {"roll", "NKF1.Roll", "deg", "autopilot's EKF2"},
      {"pitch", "NKF1.Pitch", "deg", "autopilot's EKF2"},
      {"yaw", "NKF1.Yaw", "deg", "autopilot's EKF2"},
      {"lat", "GPS.Lat", "deg", ""},
      {"lon", "GPS.Lng", "deg", ""},
      {"alt", "BARO.Alt", "m", "barometric"},
      {"alt", "GPS.Alt", "m", "GPS"},
      {"airspeed", "ARSP.Airspeed", "m/s", "indicated"},
      {"airspeed", "CTUN.As", "m/s", "indicated"},
      {"airspeed", "NTUN.Arspd", "m/s", "indicated"},
      {"dynamic_pressure", "ARSP.DiffPress", "Pa", ""},
      {"static_pressure", "BARO.Press", "Pa", ""},
      {"air_temperature", "ARSP.Temp", "degC", "airspeed sensor"},
      {"mag_x", "MAG.MagX", "mG", ""},
      {"mag_y", "MAG.MagY", "mG", ""},
      {"mag_z", "MAG.MagZ", "mG", ""},
  };
  return table;
}

void map_gps_velocity(MapBuilder& builder) {
  const Channel* speed = builder.alive("GPS.Spd");
  const Channel* course = builder.alive("GPS.GCrs");
  if (speed == nullptr || course == nullptr || speed->size() != course->size()) return;
  const Channel* down = builder.alive("GPS.VZ");
  const bool course_in_degrees = course->unit.same_dimension(Unit{});
  std::vector<double> north(speed->size());
  std::vector<double> east(speed->size());
  for (std::size_t i = 0; i < north.size(); ++i) {
    const double angle = course_in_degrees ? course->value[i] * kPi / 180.0 : course->value[i];
    north[i] = speed->value[i] * std::cos(angle);
    east[i] = speed->value[i] * std::sin(angle);
  }
  builder.put("vel_north", "m/s", speed->time, std::move(north), "GPS.Spd, GPS.GCrs");
  builder.put("vel_east", "m/s", speed->time, std::move(east), "GPS.Spd, GPS.GCrs");
  if (down != nullptr) builder.put("vel_down", "m/s", down->time, down->value, "GPS.VZ");
}

double parameter(const Recording& log, const std::string& name, double otherwise) {
  const auto found = log.parameters.find(name);
  return found == log.parameters.end() ? otherwise : found->second;
}

/// A servo output in microseconds as deflection: -1..1 about its trim, times the full throw (throttle: 0..1).
void map_servo(MapBuilder& builder, const std::string& channel, int function, int usual_output, double full_throw) {
  const Recording& log = builder.log();
  int output = 0;
  for (int n = 1; n <= 16 && output == 0; ++n) {
    if (parameter(log, fmt::format("SERVO{}_FUNCTION", n), -1.0) == function) output = n;
  }
  const bool assumed = output == 0;
  if (assumed) output = usual_output;
  const std::string name = fmt::format("RCOU.C{}", output);
  const std::string old_name = fmt::format("RCOU.Ch{}", output);
  const Channel* raw = builder.alive(log.has(name) ? name : old_name);
  if (raw == nullptr || builder.mapped(channel)) return;
  const bool modern = log.parameters.contains(fmt::format("SERVO{}_MIN", output));
  const std::string prefix = fmt::format("{}{}_", modern ? "SERVO" : "RC", output);
  const double low = parameter(log, prefix + "MIN", 1000.0);
  const double high = parameter(log, prefix + "MAX", 2000.0);
  const double trim = parameter(log, prefix + "TRIM", 1500.0);
  const bool reversed =
      modern ? parameter(log, prefix + "REVERSED", 0.0) > 0.5 : parameter(log, prefix + "REV", 1.0) < 0.0;
  const double sign = reversed ? -1.0 : 1.0;
  // Logs that know their units give pulse lengths in seconds here, parameters are in microseconds.
  const double to_us = raw->unit.same_dimension(parse_unit("s")) ? 1e6 : 1.0;
  std::vector<double> value(raw->size());
  const bool throttle = channel == "throttle";
  for (std::size_t i = 0; i < value.size(); ++i) {
    const double pulse = to_us * raw->value[i];
    if (throttle) {
      value[i] = reversed ? (high - pulse) / (high - low) : (pulse - low) / (high - low);
    } else {
      value[i] = sign * full_throw * (pulse - trim) / (pulse >= trim ? high - trim : trim - low);
    }
  }
  builder.put(channel, throttle ? "1" : "rad", raw->time, std::move(value), raw->name,
              assumed ? fmt::format("servo {} assumed: the log has no SERVOn_FUNCTION", output)
                      : fmt::format("servo {} by SERVO{}_FUNCTION", output, output));
}

}  // namespace

bool is_ardupilot(const Recording& log) {
  for (const char* name : {"IMU.AccX", "ATT.Roll", "NTUN.Arspd", "RCOU.C1", "XKF1.VN", "CTUN.ThrOut", "AHR2.Roll"}) {
    if (log.has(name)) return true;
  }
  return false;
}

void map_ardupilot(MapBuilder& builder, const SurfaceThrows& throws) {
  builder.apply(ardupilot_rules());
  map_gps_velocity(builder);
  // SERVOn_FUNCTION: 4 aileron, 19 elevator, 21 rudder, 70 throttle (ArduPilot parameter list).
  map_servo(builder, "aileron", 4, 1, throws.aileron);
  map_servo(builder, "elevator", 19, 2, throws.elevator);
  map_servo(builder, "throttle", 70, 3, 1.0);
  map_servo(builder, "rudder", 21, 4, throws.rudder);
  if (!throws.known && (builder.mapped("elevator") || builder.mapped("aileron"))) {
    builder.note(
        "surface throws are not in the subject: servo positions are scaled to 0.35 rad, so control derivatives are "
        "relative");
  }
  if (builder.log().has("AOA.AOA")) {
    builder.note("AOA is the autopilot's estimate from airspeed, wind and velocity, not a vane: not used");
  }
}

}  // namespace veridyn::aircraft::internal
