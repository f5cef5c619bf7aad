#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "veridyn/aircraft/sensors/airspeed_map.hpp"
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
      {"static_pressure", "BARO.Press", "Pa", ""},
      {"air_temperature", "ARSP.Temp", "degC", "airspeed sensor"},
      {"mag_x", "MAG.MagX", "mG", ""},
      {"mag_y", "MAG.MagY", "mG", ""},
      {"mag_z", "MAG.MagZ", "mG", ""},
  };
  return table;
}

const std::vector<AirspeedSource>& ardupilot_airspeeds() {
  static const std::vector<AirspeedSource> table{
      {"ARSP.Airspeed", AirspeedKind::kEquivalent, "m/s", "of the indicated airspeed"},
      {"CTUN.As", AirspeedKind::kEquivalent, "m/s", "of the indicated airspeed"},
      {"NTUN.Arspd", AirspeedKind::kEquivalent, "m/s", "of the indicated airspeed"},
      {"ARSP.DiffPress", AirspeedKind::kRawPressure, "Pa", "as the sensor gives it, without ARSPD_RATIO"}};
  return table;
}

void map_gps_velocity(MapBuilder& builder) {
  const Channel* speed = builder.alive("GPS.Spd");
  const Channel* course = builder.alive("GPS.GCrs");
  if (builder.mapped("vel_north")) {
    builder.leave("GPS.Spd", "vel_north");
    return;
  }
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

/// The position of a servo: -1..1 about its trim, in the sense of the autopilot's command; of a throttle 0..1.
struct ServoPosition {
  TimeBase time;
  std::vector<double> value;
  std::string source;
};

/// The channel with the pulses of an output.
std::string servo_channel(const Recording& log, int output, ServoOutputs outputs) {
  if (outputs == ServoOutputs::kMavlink) return fmt::format("SERVO_OUTPUT_RAW.servo{}_raw", output);
  std::string name = fmt::format("RCOU.C{}", output);
  return log.has(name) ? name : fmt::format("RCOU.Ch{}", output);
}

std::optional<ServoPosition> servo_position(MapBuilder& builder, int output, bool throttle, ServoOutputs outputs) {
  const Recording& log = builder.log();
  const Channel* raw = builder.alive(servo_channel(log, output, outputs));
  if (raw == nullptr) return std::nullopt;
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
  ServoPosition position{raw->time, std::vector<double>(raw->size()), raw->name};
  for (std::size_t i = 0; i < position.value.size(); ++i) {
    const double pulse = to_us * raw->value[i];
    if (throttle) {
      position.value[i] = reversed ? (high - pulse) / (high - low) : (pulse - low) / (high - low);
    } else {
      position.value[i] = sign * (pulse - trim) / (pulse >= trim ? high - trim : trim - low);
    }
  }
  return position;
}

/// Outputs with a function by SERVOn_FUNCTION.
std::vector<int> outputs_with(const Recording& log, int function) {
  constexpr int kOutputs = 32;
  std::vector<int> outputs;
  for (int n = 1; n <= kOutputs; ++n)
    if (parameter(log, fmt::format("SERVO{}_FUNCTION", n), -1.0) == function) outputs.push_back(n);
  return outputs;
}

/// The weighted sum of servos as deflection of `channel`.
void put_servos(MapBuilder& builder, const std::string& channel,
                const std::vector<std::pair<ServoPosition, double>>& servos, double full_throw,
                const std::string& note) {
  const TimeBase time = servos.front().first.time;
  std::vector<double> value(time->size(), 0.0);
  std::string sources;
  for (const auto& [servo, weight] : servos) {
    const std::vector<double> at =
        servo.time == time ? servo.value : interpolated(make_channel("servo", "1", servo.time, servo.value), *time);
    for (std::size_t i = 0; i < value.size(); ++i) value[i] += full_throw * weight * at[i];
    sources += (sources.empty() ? "" : ", ") + servo.source;
  }
  builder.put(channel, channel == "throttle" ? "1" : "rad", time, std::move(value), sources, note);
}

/// All servos of one function: both ailerons count half each.
void map_servo(MapBuilder& builder, const std::string& channel, int function, int usual_output, double full_throw,
               ServoOutputs where) {
  if (builder.mapped(channel)) return;
  std::vector<int> outputs = outputs_with(builder.log(), function);
  // A log that says what its servos do, says that this one is not there.
  const bool assumed =
      outputs.empty() && where == ServoOutputs::kDataflash && !builder.log().parameters.contains("SERVO1_FUNCTION");
  if (assumed) outputs = {usual_output};
  std::vector<std::pair<ServoPosition, double>> servos;
  std::vector<std::string> names;
  for (const int output : outputs) {
    auto position = servo_position(builder, output, channel == "throttle", where);
    if (!position) continue;
    servos.emplace_back(std::move(*position), 1.0);
    names.push_back(fmt::format("SERVO{}_FUNCTION", output));
  }
  if (servos.empty()) return;
  for (auto& [servo, weight] : servos) weight = 1.0 / static_cast<double>(servos.size());
  put_servos(builder, channel, servos, full_throw,
             assumed ? fmt::format("servo {} assumed: the log has no SERVOn_FUNCTION", usual_output)
                     : fmt::format("by {}{}", fmt::join(names, ", "), servos.size() > 1 ? ", their mean" : ""));
}

/// Two surfaces that the autopilot mixes of two commands (channel_function_mixer in ArduPlane's servos.cpp):
/// left = common - differential and right = common + differential of elevons; of a V-tail the other way round.
struct MixedPair {
  int left_function;
  int right_function;
  std::string_view what;
  std::string_view common;        ///< channel of half the sum
  std::string_view differential;  ///< channel of half the difference
  double sign;                    ///< of right - left
};

void map_pair(MapBuilder& builder, const MixedPair& pair, double common_throw, double differential_throw,
              ServoOutputs where) {
  const std::vector<int> left = outputs_with(builder.log(), pair.left_function);
  const std::vector<int> right = outputs_with(builder.log(), pair.right_function);
  if (left.empty() && right.empty()) return;
  const auto first = left.empty() ? std::nullopt : servo_position(builder, left.front(), false, where);
  const auto second = right.empty() ? std::nullopt : servo_position(builder, right.front(), false, where);
  if (!first || !second) {
    builder.note(fmt::format("only one of the {} is recorded, of which both are needed: not used", pair.what));
    return;
  }
  const std::string by =
      fmt::format("of {} SERVO{}_FUNCTION and SERVO{}_FUNCTION", pair.what, left.front(), right.front());
  if (!builder.mapped(pair.common)) {
    put_servos(builder, std::string(pair.common), {{*first, 0.5}, {*second, 0.5}}, common_throw, "half the sum " + by);
  }
  if (!builder.mapped(pair.differential)) {
    put_servos(builder, std::string(pair.differential), {{*first, -0.5 * pair.sign}, {*second, 0.5 * pair.sign}},
               differential_throw, "half the difference " + by);
  }
}

}  // namespace

bool is_ardupilot(const Recording& log) {
  for (const char* name : {"IMU.AccX", "ATT.Roll", "NTUN.Arspd", "RCOU.C1", "XKF1.VN", "CTUN.ThrOut", "AHR2.Roll"}) {
    if (log.has(name)) return true;
  }
  return false;
}

void map_servos(MapBuilder& builder, const SurfaceThrows& throws, ServoOutputs outputs) {
  // Elevons 77 and 78, V-tail 79 and 80.
  map_pair(builder, {77, 78, "elevons", "elevator", "aileron", 1.0}, throws.elevator, throws.aileron, outputs);
  map_pair(builder, {79, 80, "V-tail", "elevator", "rudder", -1.0}, throws.elevator, throws.rudder, outputs);
  // SERVOn_FUNCTION: 4 aileron, 19 elevator, 21 rudder, 70 throttle (ArduPilot parameter list).
  map_servo(builder, "aileron", 4, 1, throws.aileron, outputs);
  map_servo(builder, "elevator", 19, 2, throws.elevator, outputs);
  map_servo(builder, "throttle", 70, 3, 1.0, outputs);
  map_servo(builder, "rudder", 21, 4, throws.rudder, outputs);
  if (!outputs_with(builder.log(), 24).empty() && outputs_with(builder.log(), 4).empty()) {
    builder.note(
        "flaperons (SERVOn_FUNCTION 24 and 25) are mixed in other ways by each release: map aileron in [data.map]");
  }
  if (outputs == ServoOutputs::kMavlink && !builder.mapped("elevator") &&
      builder.log().has("SERVO_OUTPUT_RAW.servo1_raw")) {
    builder.note(
        "servo pulses are recorded, but no SERVOn_FUNCTION that says which surface each moves: ground stations record "
        "parameters as they load them; map the surfaces in [data.map]");
  }
  if (!throws.known && (builder.mapped("elevator") || builder.mapped("aileron"))) {
    builder.note(
        "surface throws are not in the subject: servo positions are scaled to 0.35 rad, so control derivatives are "
        "relative");
  }
}

void map_ardupilot(MapBuilder& builder, const SurfaceThrows& throws) {
  const Channel* gps = builder.alive("GPS.GCrs") != nullptr ? builder.alive("GPS.Spd") : nullptr;
  map_filter_velocity(builder, {"XKF1.VN", "XKF1.VE", "XKF1.VD"}, gps, "autopilot's EKF3");
  map_filter_velocity(builder, {"NKF1.VN", "NKF1.VE", "NKF1.VD"}, gps, "autopilot's EKF2");
  map_gps_velocity(builder);
  map_ardupilot_pressure(builder);
  map_airspeed(builder, ardupilot_airspeeds());
  builder.apply(ardupilot_rules());
  map_servos(builder, throws, ServoOutputs::kDataflash);
  if (builder.log().has("AOA.AOA")) {
    builder.note("AOA is the autopilot's estimate from airspeed, wind and velocity, not a vane: not used");
  }
}

}  // namespace veridyn::aircraft::internal
