#include <fmt/format.h>

#include <array>
#include <cmath>

#include "veridyn/aircraft/sensors/airspeed_map.hpp"
#include "veridyn/aircraft/sensors/channel_rules.hpp"

namespace veridyn::aircraft::internal {
namespace {

// Topic and field names drift between PX4 releases; each row names the releases in which it holds. ULog gives no units,
// these are those of the message definitions (msg/*.msg).
const std::vector<ChannelRule>& px4_rules() {
  static const std::vector<ChannelRule> table{
      {"accel_x", "vehicle_acceleration.xyz[0]", "m/s^2", "1.11 and later"},
      {"accel_y", "vehicle_acceleration.xyz[1]", "m/s^2", "1.11 and later"},
      {"accel_z", "vehicle_acceleration.xyz[2]", "m/s^2", "1.11 and later"},
      {"accel_x", "sensor_combined.accelerometer_m_s2[0]", "m/s^2", "all releases"},
      {"accel_y", "sensor_combined.accelerometer_m_s2[1]", "m/s^2", "all releases"},
      {"accel_z", "sensor_combined.accelerometer_m_s2[2]", "m/s^2", "all releases"},
      {"gyro_x", "vehicle_angular_velocity.xyz[0]", "rad/s", "1.10 and later"},
      {"gyro_y", "vehicle_angular_velocity.xyz[1]", "rad/s", "1.10 and later"},
      {"gyro_z", "vehicle_angular_velocity.xyz[2]", "rad/s", "1.10 and later"},
      {"gyro_x", "vehicle_attitude.rollspeed", "rad/s", "before 1.10"},
      {"gyro_y", "vehicle_attitude.pitchspeed", "rad/s", "before 1.10"},
      {"gyro_z", "vehicle_attitude.yawspeed", "rad/s", "before 1.10"},
      {"gyro_x", "sensor_combined.gyro_rad[0]", "rad/s", "all releases"},
      {"gyro_y", "sensor_combined.gyro_rad[1]", "rad/s", "all releases"},
      {"gyro_z", "sensor_combined.gyro_rad[2]", "rad/s", "all releases"},
      {"vel_north", "vehicle_gps_position.vel_n_m_s", "m/s", "GPS"},
      {"vel_east", "vehicle_gps_position.vel_e_m_s", "m/s", "GPS"},
      {"vel_down", "vehicle_gps_position.vel_d_m_s", "m/s", "GPS"},
      {"vel_north", "vehicle_local_position.vx", "m/s", "autopilot's filter"},
      {"vel_east", "vehicle_local_position.vy", "m/s", "autopilot's filter"},
      {"vel_down", "vehicle_local_position.vz", "m/s", "autopilot's filter"},
      {"lat", "vehicle_gps_position.latitude_deg", "deg", "1.14 and later"},
      {"lon", "vehicle_gps_position.longitude_deg", "deg", "1.14 and later"},
      {"alt", "vehicle_gps_position.altitude_msl_m", "m", "1.14 and later"},
      {"lat", "vehicle_gps_position.lat", "deg", "before 1.14", 1e-7},
      {"lon", "vehicle_gps_position.lon", "deg", "before 1.14", 1e-7},
      {"alt", "vehicle_gps_position.alt", "mm", "before 1.14"},
      {"static_pressure", "vehicle_air_data.baro_pressure_pa", "Pa", ""},
      {"static_pressure", "sensor_baro.pressure", "mbar", "before 1.13"},
      {"air_temperature", "airspeed.air_temperature_celsius", "degC", ""},
      {"air_temperature", "vehicle_air_data.baro_temp_celcius", "degC", "barometer's"},
      {"air_density", "vehicle_air_data.rho", "kg/m^3", ""},
  };
  return table;
}

/// What the autopilot checked and corrected before what the sensor gives.
const std::vector<AirspeedSource>& px4_airspeeds() {
  static const std::vector<AirspeedSource> table{
      {"airspeed_validated.true_airspeed_m_s", AirspeedKind::kTrue, "m/s", "true, validated; 1.11 and later"},
      {"airspeed_validated.calibrated_airspeed_m_s", AirspeedKind::kEquivalent, "m/s", "of the calibrated airspeed"},
      {"airspeed.true_airspeed_m_s", AirspeedKind::kTrue, "m/s", "true"},
      {"airspeed.indicated_airspeed_m_s", AirspeedKind::kEquivalent, "m/s", "of the indicated airspeed"},
      {"differential_pressure.differential_pressure_filtered_pa", AirspeedKind::kRawPressure, "Pa",
       "as the sensor gives it; before 1.14"},
      {"differential_pressure.differential_pressure_pa", AirspeedKind::kRawPressure, "Pa",
       "as the sensor gives it; 1.13 and later"}};
  return table;
}

void map_attitude(MapBuilder& builder) {
  std::array<const Channel*, 4> q{};
  for (std::size_t i = 0; i < 4; ++i) q[i] = builder.log().find(fmt::format("vehicle_attitude.q[{}]", i));
  if (q[0] == nullptr || q[1] == nullptr || q[2] == nullptr || q[3] == nullptr || q[0]->empty()) return;
  put_attitude(builder, q, "vehicle_attitude.q");
}

/// Normalised controls -1..1 times the full throw. Positive PX4 control rolls right, pitches up, yaws right; a positive
/// deflection here does the opposite for elevator and rudder (trailing edge down, left) and aileron (right edge down),
/// as in the UMN, X8 and DLR tables.
void map_controls(MapBuilder& builder, const SurfaceThrows& throws) {
  // A VTOL flies its wing from group 1.
  const bool vtol =
      builder.log().has("actuator_controls_1.control[0]") && builder.log().has("vtol_vehicle_status.timestamp");
  const std::string group = vtol ? "actuator_controls_1" : "actuator_controls_0";
  struct Control {
    const char* channel;
    std::vector<std::string> sources;
    double scale;
  };
  const std::vector<Control> controls{
      {"aileron", {group + ".control[0]", "vehicle_torque_setpoint.xyz[0]"}, -throws.aileron},
      {"elevator", {group + ".control[1]", "vehicle_torque_setpoint.xyz[1]"}, -throws.elevator},
      {"rudder", {group + ".control[2]", "vehicle_torque_setpoint.xyz[2]"}, -throws.rudder},
      {"throttle", {group + ".control[3]", "vehicle_thrust_setpoint.xyz[0]"}, 1.0},
  };
  for (const Control& control : controls) {
    if (builder.mapped(control.channel)) continue;
    for (const std::string& source : control.sources) {
      const Channel* raw = builder.alive(source);
      if (raw == nullptr) continue;
      std::vector<double> value = raw->value;
      for (double& v : value) v *= control.scale;
      builder.put(control.channel, control.scale == 1.0 ? "1" : "rad", raw->time, std::move(value), source,
                  "commanded; positive deflections give negative moments");
      break;
    }
  }
  if (!throws.known && (builder.mapped("elevator") || builder.mapped("aileron"))) {
    builder.note(
        "surface throws are not in the subject: controls are scaled to 0.35 rad, so control derivatives are relative");
  }
}

}  // namespace

void put_attitude(MapBuilder& builder, const std::array<const Channel*, 4>& q, const std::string& source,
                  const std::string& note) {
  const std::size_t n = q[0]->size();
  std::vector<double> roll(n);
  std::vector<double> pitch(n);
  std::vector<double> yaw(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double w = q[0]->value[i];
    const double x = q[1]->value[i];
    const double y = q[2]->value[i];
    const double z = q[3]->value[i];
    roll[i] = std::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y));
    pitch[i] = std::asin(std::min(1.0, std::max(-1.0, 2.0 * (w * y - z * x))));
    yaw[i] = std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
  }
  builder.put("roll", "rad", q[0]->time, std::move(roll), source, note);
  builder.put("pitch", "rad", q[0]->time, std::move(pitch), source, note);
  builder.put("yaw", "rad", q[0]->time, std::move(yaw), source, note);
}

bool is_px4(const Recording& log) {
  for (const char* name : {"vehicle_attitude.q[0]", "sensor_combined.gyro_rad[0]", "vehicle_angular_velocity.xyz[0]"}) {
    if (log.has(name)) return true;
  }
  return false;
}

void map_px4(MapBuilder& builder, const SurfaceThrows& throws) {
  if (const Channel* gps = builder.alive("vehicle_gps_position.vel_n_m_s"))
    map_filter_velocity(builder,
                        {"vehicle_local_position.vx", "vehicle_local_position.vy", "vehicle_local_position.vz"}, gps,
                        "autopilot's filter");
  map_airspeed(builder, px4_airspeeds());
  builder.apply(px4_rules());
  map_attitude(builder);
  map_controls(builder, throws);
}

}  // namespace veridyn::aircraft::internal
