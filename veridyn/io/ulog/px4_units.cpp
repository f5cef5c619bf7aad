#include "veridyn/io/ulog/px4_units.hpp"

#include <map>
#include <utility>

namespace veridyn::io {
namespace {

using MessageField = std::pair<std::string_view, std::string_view>;

const std::map<MessageField, Px4Unit>& table() {
  static const std::map<MessageField, Px4Unit> units = [] {
    std::map<MessageField, Px4Unit> result;
    const auto put = [&](std::initializer_list<std::string_view> topics, std::initializer_list<std::string_view> fields,
                         const char* unit, double scale = 1.0) {
      for (const auto topic : topics) {
        for (const auto field : fields) result[{topic, field}] = {unit, scale};
      }
    };
    put({"sensor_combined", "sensor_gyro", "vehicle_imu"}, {"gyro_rad"}, "rad/s");
    put({"sensor_gyro"}, {"x", "y", "z"}, "rad/s");
    put({"sensor_accel"}, {"x", "y", "z"}, "m/s^2");
    put({"sensor_accel", "sensor_gyro", "sensor_mag", "sensor_baro", "differential_pressure"}, {"temperature"}, "degC");
    put({"sensor_mag"}, {"x", "y", "z"}, "gauss");
    put({"vehicle_magnetometer"}, {"magnetometer_ga"}, "gauss");
    put({"sensor_combined"}, {"magnetometer_ga"}, "gauss");
    put({"vehicle_angular_velocity"}, {"xyz"}, "rad/s");
    put({"vehicle_angular_velocity"}, {"xyz_derivative"}, "rad/s^2");
    put({"vehicle_angular_acceleration"}, {"xyz"}, "rad/s^2");
    put({"vehicle_acceleration"}, {"xyz"}, "m/s^2");
    put({"vehicle_imu"}, {"delta_angle"}, "rad");
    put({"vehicle_imu"}, {"delta_velocity"}, "m/s");
    put({"vehicle_attitude", "vehicle_attitude_groundtruth"}, {"rollspeed", "pitchspeed", "yawspeed"}, "rad/s");
    put({"vehicle_attitude_setpoint"}, {"roll_body", "pitch_body", "yaw_body"}, "rad");
    put({"vehicle_rates_setpoint"}, {"roll", "pitch", "yaw"}, "rad/s");
    put({"vehicle_local_position", "vehicle_local_position_groundtruth", "vehicle_odometry"}, {"x", "y", "z"}, "m");
    put({"vehicle_local_position", "vehicle_local_position_groundtruth", "vehicle_odometry"}, {"vx", "vy", "vz"},
        "m/s");
    put({"vehicle_local_position", "vehicle_local_position_groundtruth"}, {"ax", "ay", "az"}, "m/s^2");
    put({"vehicle_local_position", "vehicle_local_position_groundtruth"}, {"heading", "yaw"}, "rad");
    put({"vehicle_local_position"}, {"ref_lat", "ref_lon"}, "deg");
    put({"vehicle_local_position"}, {"ref_alt", "eph", "epv", "dist_bottom", "delta_xy", "delta_z"}, "m");
    put({"vehicle_local_position"}, {"evh", "evv", "z_deriv", "delta_vxy", "delta_vz", "dist_bottom_rate"}, "m/s");
    put({"vehicle_odometry"}, {"rollspeed", "pitchspeed", "yawspeed"}, "rad/s");
    put({"vehicle_odometry"}, {"position"}, "m");
    put({"vehicle_odometry"}, {"velocity"}, "m/s");
    put({"vehicle_odometry"}, {"angular_velocity"}, "rad/s");
    put({"vehicle_global_position", "vehicle_global_position_groundtruth"}, {"lat", "lon"}, "deg");
    put({"vehicle_global_position", "vehicle_global_position_groundtruth"},
        {"alt", "alt_ellipsoid", "eph", "epv", "terrain_alt"}, "m");
    put({"vehicle_global_position", "vehicle_global_position_groundtruth"}, {"vel_n", "vel_e", "vel_d"}, "m/s");
    put({"vehicle_global_position"}, {"yaw"}, "rad");
    put({"home_position"}, {"lat", "lon"}, "deg");
    put({"home_position"}, {"alt", "x", "y", "z"}, "m");
    // Integers up to PX4 1.13; latitude_deg and altitude_msl_m later.
    put({"vehicle_gps_position", "sensor_gps"}, {"lat", "lon"}, "deg", 1e-7);
    put({"vehicle_gps_position", "sensor_gps"}, {"alt", "alt_ellipsoid"}, "m", 1e-3);
    put({"vehicle_gps_position", "sensor_gps"}, {"eph", "epv"}, "m");
    put({"vehicle_gps_position", "sensor_gps"}, {"heading", "heading_offset"}, "rad");
    put({"vehicle_gps_position", "sensor_gps"}, {"latitude_deg", "longitude_deg"}, "deg");
    put({"wind", "wind_estimate"}, {"windspeed_north", "windspeed_east"}, "m/s");
    put({"vehicle_air_data"}, {"baro_alt_meter"}, "m");
    put({"vehicle_air_data"}, {"rho"}, "kg/m^3");
    put({"sensor_baro"}, {"pressure"}, "Pa");
    put({"airspeed_validated"}, {"calibrated_ground_minus_wind_m_s"}, "m/s");
    put({"actuator_outputs"}, {"output"}, "us");
    put({"input_rc"}, {"values"}, "us");
    put({"battery_status"}, {"voltage_v", "voltage_filtered_v"}, "V");
    put({"battery_status"}, {"current_a", "current_filtered_a", "current_average_a"}, "A");
    put({"battery_status"}, {"discharged_mah"}, "mA h");
    put({"battery_status"}, {"temperature"}, "degC");
    put({"esc_status"}, {"esc_rpm"}, "rpm");
    put({"esc_status"}, {"esc_voltage"}, "V");
    put({"esc_status"}, {"esc_current"}, "A");
    put({"esc_status"}, {"esc_temperature"}, "degC");
    put({"rpm"}, {"indicated_frequency_rpm", "estimated_accurancy_rpm", "rpm_estimate", "rpm_raw"}, "rpm");
    return result;
  }();
  return units;
}

}  // namespace

Px4Unit px4_unit(std::string_view topic, std::string_view field) {
  const auto& units = table();
  if (const auto found = units.find({topic, field}); found != units.end()) return found->second;
  // The longer endings first: "_m_s" also ends in "_s".
  constexpr std::pair<std::string_view, const char*> kEndings[] = {
      {"_m_s2", "m/s^2"}, {"_m_s", "m/s"},       {"_rad_s2", "rad/s^2"}, {"_rad_s", "rad/s"},  {"_deg_s", "deg/s"},
      {"_rad", "rad"},    {"_deg", "deg"},       {"_pa", "Pa"},          {"_celsius", "degC"}, {"_celcius", "degC"},
      {"_msl_m", "m"},    {"_ellipsoid_m", "m"}, {"_hz", "Hz"},          {"_ga", "gauss"}};
  for (const auto& [ending, unit] : kEndings) {
    if (field.size() > ending.size() && field.substr(field.size() - ending.size()) == ending) return {unit, 1.0};
  }
  return {};
}

}  // namespace veridyn::io
