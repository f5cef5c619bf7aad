#include <array>
#include <cmath>

#include "veridyn/aircraft/sensors/airspeed_map.hpp"
#include "veridyn/aircraft/sensors/channel_rules.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft::internal {
namespace {

/// Messages of common.xml, those that come oftenest or are least processed first. Units are in the log.
const std::vector<ChannelRule>& mavlink_rules() {
  static const std::vector<ChannelRule> table{
      {"accel_x", "HIGHRES_IMU.xacc", "m/s^2", ""},
      {"accel_y", "HIGHRES_IMU.yacc", "m/s^2", ""},
      {"accel_z", "HIGHRES_IMU.zacc", "m/s^2", ""},
      {"gyro_x", "HIGHRES_IMU.xgyro", "rad/s", ""},
      {"gyro_y", "HIGHRES_IMU.ygyro", "rad/s", ""},
      {"gyro_z", "HIGHRES_IMU.zgyro", "rad/s", ""},
      {"accel_x", "SCALED_IMU.xacc", "m/s^2", "in steps of 0.001 g"},
      {"accel_y", "SCALED_IMU.yacc", "m/s^2", "in steps of 0.001 g"},
      {"accel_z", "SCALED_IMU.zacc", "m/s^2", "in steps of 0.001 g"},
      {"gyro_x", "SCALED_IMU.xgyro", "rad/s", "in steps of 0.06 deg/s"},
      {"gyro_y", "SCALED_IMU.ygyro", "rad/s", "in steps of 0.06 deg/s"},
      {"gyro_z", "SCALED_IMU.zgyro", "rad/s", "in steps of 0.06 deg/s"},
      {"accel_x", "RAW_IMU.xacc", "m/s^2", "as ArduPilot fills it: thousandths of g"},
      {"accel_y", "RAW_IMU.yacc", "m/s^2", "as ArduPilot fills it: thousandths of g"},
      {"accel_z", "RAW_IMU.zacc", "m/s^2", "as ArduPilot fills it: thousandths of g"},
      {"gyro_x", "RAW_IMU.xgyro", "rad/s", "as ArduPilot fills it: mrad/s"},
      {"gyro_y", "RAW_IMU.ygyro", "rad/s", "as ArduPilot fills it: mrad/s"},
      {"gyro_z", "RAW_IMU.zgyro", "rad/s", "as ArduPilot fills it: mrad/s"},
      {"gyro_x", "ATTITUDE.rollspeed", "rad/s", "autopilot's filter"},
      {"gyro_y", "ATTITUDE.pitchspeed", "rad/s", "autopilot's filter"},
      {"gyro_z", "ATTITUDE.yawspeed", "rad/s", "autopilot's filter"},
      {"roll", "ATTITUDE.roll", "rad", "autopilot's filter"},
      {"pitch", "ATTITUDE.pitch", "rad", "autopilot's filter"},
      {"yaw", "ATTITUDE.yaw", "rad", "autopilot's filter"},
      {"vel_north", "GLOBAL_POSITION_INT.vx", "m/s", "autopilot's filter, in steps of 1 cm/s"},
      {"vel_east", "GLOBAL_POSITION_INT.vy", "m/s", "autopilot's filter, in steps of 1 cm/s"},
      {"vel_down", "GLOBAL_POSITION_INT.vz", "m/s", "autopilot's filter, in steps of 1 cm/s"},
      {"lat", "GPS_RAW_INT.lat", "deg", ""},
      {"lon", "GPS_RAW_INT.lon", "deg", ""},
      {"alt", "GPS_RAW_INT.alt", "m", "GPS"},
      {"lat", "GLOBAL_POSITION_INT.lat", "deg", "autopilot's filter"},
      {"lon", "GLOBAL_POSITION_INT.lon", "deg", "autopilot's filter"},
      {"alt", "GLOBAL_POSITION_INT.alt", "m", "autopilot's filter"},
      {"static_pressure", "SCALED_PRESSURE.press_abs", "mbar", ""},
      {"static_pressure", "HIGHRES_IMU.abs_pressure", "mbar", ""},
      {"air_temperature", "AIRSPEED.temperature", "degC", "airspeed sensor"},
      {"air_temperature", "SCALED_PRESSURE.temperature", "degC", "barometer's"},
      {"mag_x", "HIGHRES_IMU.xmag", "mG", ""},
      {"mag_y", "HIGHRES_IMU.ymag", "mG", ""},
      {"mag_z", "HIGHRES_IMU.zmag", "mG", ""},
      {"mag_x", "RAW_IMU.xmag", "mG", "as ArduPilot fills it"},
      {"mag_y", "RAW_IMU.ymag", "mG", "as ArduPilot fills it"},
      {"mag_z", "RAW_IMU.zmag", "mG", "as ArduPilot fills it"},
      {"engine_speed", "RPM.rpm1", "rpm", ""},
  };
  return table;
}

/// What the autopilot calibrated before what the sensor gives.
const std::vector<AirspeedSource>& mavlink_airspeeds() {
  static const std::vector<AirspeedSource> table{
      {"AIRSPEED.airspeed", AirspeedKind::kEquivalent, "m/s", "of the indicated airspeed"},
      {"VFR_HUD.airspeed", AirspeedKind::kEquivalent, "m/s", "of the indicated airspeed"},
      {"SCALED_PRESSURE.press_diff", AirspeedKind::kRawPressure, "mbar", "as the sensor gives it"},
      {"HIGHRES_IMU.diff_pressure", AirspeedKind::kRawPressure, "mbar", "as the sensor gives it"}};
  return table;
}

/// The components of LOCAL_POSITION_NED's velocity, all or none: in floating point.
void map_local_velocity(MapBuilder& builder) {
  const std::array<const char*, 3> sources{"LOCAL_POSITION_NED.vx", "LOCAL_POSITION_NED.vy", "LOCAL_POSITION_NED.vz"};
  const std::array<const char*, 3> channels{"vel_north", "vel_east", "vel_down"};
  for (const char* source : sources)
    if (builder.alive(source) == nullptr) return;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (builder.mapped(channels[i])) continue;
    const Channel& raw = *builder.alive(sources[i]);
    builder.put(channels[i], "m/s", raw.time, raw.value, sources[i], "autopilot's filter");
  }
}

/// Speed and course of GPS, where no filter gives a velocity: without its vertical component.
void map_course_velocity(MapBuilder& builder) {
  if (builder.mapped("vel_north")) return;
  const Channel* speed = builder.alive("GPS_RAW_INT.vel");
  const Channel* course = builder.alive("GPS_RAW_INT.cog");
  if (speed == nullptr || course == nullptr) return;
  std::vector<double> north(speed->size()), east(speed->size());
  for (std::size_t i = 0; i < north.size(); ++i) {
    north[i] = speed->value[i] * std::cos(course->value[i]);
    east[i] = speed->value[i] * std::sin(course->value[i]);
  }
  builder.put("vel_north", "m/s", speed->time, std::move(north), "GPS_RAW_INT.vel, GPS_RAW_INT.cog");
  builder.put("vel_east", "m/s", speed->time, std::move(east), "GPS_RAW_INT.vel, GPS_RAW_INT.cog");
}

/// ATTITUDE_QUATERNION, where there is no ATTITUDE.
void map_quaternion(MapBuilder& builder) {
  if (builder.mapped("roll")) return;
  std::array<const Channel*, 4> q{};
  for (std::size_t i = 0; i < 4; ++i)
    q[i] = builder.log().find(std::array{"ATTITUDE_QUATERNION.q1", "ATTITUDE_QUATERNION.q2", "ATTITUDE_QUATERNION.q3",
                                         "ATTITUDE_QUATERNION.q4"}[i]);
  if (q[0] == nullptr || q[0]->empty()) return;
  put_attitude(builder, q, "ATTITUDE_QUATERNION");
}

/// Normalised commands -1..1 of an autopilot that sends them (PX4): group 0 is roll, pitch, yaw and thrust.
void map_control_targets(MapBuilder& builder, const SurfaceThrows& throws) {
  struct Control {
    const char* channel;
    const char* source;
    double scale;
  };
  for (const Control& control : {Control{"aileron", "ACTUATOR_CONTROL_TARGET.controls[0]", -throws.aileron},
                                 Control{"elevator", "ACTUATOR_CONTROL_TARGET.controls[1]", -throws.elevator},
                                 Control{"rudder", "ACTUATOR_CONTROL_TARGET.controls[2]", -throws.rudder},
                                 Control{"throttle", "ACTUATOR_CONTROL_TARGET.controls[3]", 1.0}}) {
    if (builder.mapped(control.channel)) continue;
    const Channel* raw = builder.alive(control.source);
    if (raw == nullptr) continue;
    std::vector<double> value = raw->value;
    for (double& v : value) v *= control.scale;
    builder.put(control.channel, control.scale == 1.0 ? "1" : "rad", raw->time, std::move(value), control.source,
                "commanded; positive deflections give negative moments");
  }
}

}  // namespace

bool is_mavlink(const Recording& log) {
  for (const char* name : {"ATTITUDE.roll", "ATTITUDE_QUATERNION.q1", "GLOBAL_POSITION_INT.lat", "HIGHRES_IMU.xacc"})
    if (log.has(name)) return true;
  return false;
}

void map_mavlink(MapBuilder& builder, const SurfaceThrows& throws) {
  map_local_velocity(builder);
  map_airspeed(builder, mavlink_airspeeds());
  builder.apply(mavlink_rules());
  map_course_velocity(builder);
  map_quaternion(builder);
  map_control_targets(builder, throws);
  map_servos(builder, throws, ServoOutputs::kMavlink);
}

}  // namespace veridyn::aircraft::internal
