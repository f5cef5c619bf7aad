#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/vehicle/model/vehicle_trajectory.hpp"

namespace veridyn::vehicle {

/// Error model of one channel: y = bias + (1 + scale) y_true + white noise, at the rate of the sensor, stamped late.
struct DriveSensor {
  bool enabled = true;
  double rate_Hz = 100.0;
  double sigma = 0.0;       ///< of the white noise
  double bias = 0.0;        ///< fixed
  double bias_sigma = 0.0;  ///< of a further fixed bias, drawn once per drive
  double scale = 0.0;       ///< error of scale [-]
  double delay_s = 0.0;     ///< from event to time stamp
  friend bool operator==(const DriveSensor&, const DriveSensor&) = default;
};

/// The sensors of a drive, in this order.
enum class DriveSensorKind : std::size_t { kSteer, kSpeed, kYawRate, kAccelY, kAccelX, kLateralVelocity, kPosition };
/// How many sensors there are.
inline constexpr std::size_t kDriveSensors = 7;
/// Their names in studies, in the order of the enum.
inline constexpr EnumArray<DriveSensorKind, std::string_view, kDriveSensors> kDriveSensorNames{
    "steer", "speed", "yaw_rate", "accel_y", "accel_x", "lateral_velocity", "position"};
/// Units of their errors, in the same order.
inline constexpr EnumArray<DriveSensorKind, std::string_view, kDriveSensors> kDriveSensorUnits{
    "rad", "m/s", "rad/s", "m/s^2", "m/s^2", "m/s", "m"};

/// The sensors of a vehicle and where its accelerometer is.
struct DriveSensorSet {
  EnumArray<DriveSensorKind, DriveSensor, kDriveSensors> sensors;
  std::array<double, 3> accel_position{};  ///< of the accelerometer from the centre of gravity, forward, left, up [m]
  /// A sensor on the body of a vehicle that rolls and pitches measures gravity too: g sin(roll) along y, -g sin(pitch)
  /// along x. Only where the trajectory has these angles.
  bool feels_gravity = true;
  double gravity = kGravity;
  [[nodiscard]] const DriveSensor& operator[](DriveSensorKind k) const { return sensors[k]; }
  [[nodiscard]] DriveSensor& operator[](DriveSensorKind k) { return sensors[k]; }
};

/// Sensors as production cars carry them for stability control, all at 100 Hz: yaw rate noise 0.1 deg/s with a bias of
/// 0.2 deg/s, accel_y and accel_x noise 0.05 m/s^2 with a bias of 0.1 m/s^2, steer noise 0.1 deg with a bias of 0.1 deg
/// (at the road wheels: a hand wheel resolved to 1.5 deg over a ratio of 15), speed noise 0.05 m/s; biases are drawn
/// once a drive. Orders of magnitude of automotive yaw-rate and acceleration sensors (data sheets such as Bosch MM5.10
/// promise offsets below 3 deg/s and 0.1 g before compensation; after the compensation at standstill that stability
/// control does, the above is left). lateral_velocity (an optical sensor, 0.02 m/s) and position (GNSS with
/// corrections, 0.05 m at 10 Hz) are off.
[[nodiscard]] DriveSensorSet reference_drive_sensors();

/// The keys of `[sensors]` and of a sensor's table in it, `[sensors.yaw_rate]`.
[[nodiscard]] std::vector<StudyKeys> drive_sensor_keys();

/// Reads `[sensors]`. @throws InputError naming file, line and key.
[[nodiscard]] DriveSensorSet read_drive_sensors(const StudyTable& table);

/// What the sensors record of a drive: a recording in frame flu, each sensor on a time base of its rate, values between
/// the trajectory's samples on the straight line. Each sensor draws from another random stream.
[[nodiscard]] Recording record_drive(const VehicleTrajectory& trajectory, const DriveSensorSet& sensors,
                                     std::uint64_t seed);

}  // namespace veridyn::vehicle
