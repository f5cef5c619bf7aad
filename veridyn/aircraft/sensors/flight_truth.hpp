#pragma once

#include <cstddef>
#include <string_view>

#include "veridyn/core/enum_array.hpp"

namespace veridyn::aircraft {

// clang-format off
/// What is true of the simulated aircraft at one moment.
enum class Truth : std::size_t {
  kPosNorth, kPosEast, kPosDown,
  kVelNorth, kVelEast, kVelDown,
  kRoll, kPitch, kYaw,
  kGyroX, kGyroY, kGyroZ,
  kGyroRateX, kGyroRateY, kGyroRateZ,
  kAccelX, kAccelY, kAccelZ,
  kImuAccelX, kImuAccelY, kImuAccelZ,
  kAirspeed, kAlpha, kBeta,
  kDynamicPressure, kStaticPressure, kAirTemperature, kAirDensity,
  kWindNorth, kWindEast, kWindDown,
  kMeanWindNorth, kMeanWindEast, kMeanWindDown,
  kGustX, kGustY, kGustZ,
  kElevator, kAileron, kRudder, kThrottle,
  kEngineSpeed, kThrust,
  kCL, kCD, kCY, kCl, kCm, kCn,
  kForceX, kForceY, kForceZ,
  kMomentX, kMomentY, kMomentZ,
  kMagX, kMagY, kMagZ,
  kGustRateX, kGustRateY, kGustRateZ,
  kDownwashLag,
  kElevatorCommand, kAileronCommand, kRudderCommand, kThrottleCommand,
  kCount
};
/// Values of Truth.
inline constexpr std::size_t kTruthCount = static_cast<std::size_t>(Truth::kCount);

/// Name and unit of a true quantity.
struct TruthChannel {
  std::string_view name;
  std::string_view unit;
  bool angle = false;  ///< wraps at +-pi
};

/// Names and units. `accel` is the specific force at the centre of gravity, `imu_accel` at the accelerometer; `wind` is
/// the whole motion of the air (mean and gusts, NED), `gust` the turbulence in body axes; the coefficients are those
/// that act (moments about the centre of gravity, thrust taken out); `force` and `moment` are all but gravity.
/// `gust_rate` is that of `GustGradients`, `downwash_lag` alpha - alpha_w of `Downwash`; commands are those that the
/// servos had last, within their stops.
inline constexpr EnumArray<Truth, TruthChannel, kTruthCount> kTruthChannels = {{{
    {"pos_north", "m"}, {"pos_east", "m"}, {"pos_down", "m"},
    {"vel_north", "m/s"}, {"vel_east", "m/s"}, {"vel_down", "m/s"},
    {"roll", "rad", true}, {"pitch", "rad"}, {"yaw", "rad", true},
    {"gyro_x", "rad/s"}, {"gyro_y", "rad/s"}, {"gyro_z", "rad/s"},
    {"gyro_rate_x", "rad/s^2"}, {"gyro_rate_y", "rad/s^2"}, {"gyro_rate_z", "rad/s^2"},
    {"accel_x", "m/s^2"}, {"accel_y", "m/s^2"}, {"accel_z", "m/s^2"},
    {"imu_accel_x", "m/s^2"}, {"imu_accel_y", "m/s^2"}, {"imu_accel_z", "m/s^2"},
    {"airspeed", "m/s"}, {"alpha", "rad"}, {"beta", "rad"},
    {"dynamic_pressure", "Pa"}, {"static_pressure", "Pa"}, {"air_temperature", "K"}, {"air_density", "kg/m^3"},
    {"wind_north", "m/s"}, {"wind_east", "m/s"}, {"wind_down", "m/s"},
    {"mean_wind_north", "m/s"}, {"mean_wind_east", "m/s"}, {"mean_wind_down", "m/s"},
    {"gust_x", "m/s"}, {"gust_y", "m/s"}, {"gust_z", "m/s"},
    {"elevator", "rad"}, {"aileron", "rad"}, {"rudder", "rad"}, {"throttle", "1"},
    {"engine_speed", "rad/s"}, {"thrust", "N"},
    {"CL", "1"}, {"CD", "1"}, {"CY", "1"}, {"Cl", "1"}, {"Cm", "1"}, {"Cn", "1"},
    {"force_x", "N"}, {"force_y", "N"}, {"force_z", "N"},
    {"moment_x", "N m"}, {"moment_y", "N m"}, {"moment_z", "N m"},
    {"mag_x", "T"}, {"mag_y", "T"}, {"mag_z", "T"},
    {"gust_rate_x", "rad/s"}, {"gust_rate_y", "rad/s"}, {"gust_rate_z", "rad/s"},
    {"downwash_lag", "rad"},
    {"elevator_command", "rad"}, {"aileron_command", "rad"}, {"rudder_command", "rad"}, {"throttle_command", "1"},
}}};
// clang-format on

/// All true quantities at one moment, SI.
struct TruthSample {
  EnumArray<Truth, double, kTruthCount> value{};
  [[nodiscard]] double& operator[](Truth t) { return value[t]; }
  [[nodiscard]] double operator[](Truth t) const { return value[t]; }
};

}  // namespace veridyn::aircraft
