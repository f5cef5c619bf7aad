#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "veridyn/vehicle/tyre/wheels.hpp"

namespace veridyn::vehicle {

/// Why a simulated drive ended.
enum class DriveEnd {
  kCompleted,    ///< driven to the end
  kInterrupted,  ///< the caller's progress asked to stop
  kDiverged,     ///< the state became NaN or infinite: the step is too long for these stiffnesses
  kStopped,      ///< forward speed fell below 0.5 m/s, where slip angles lose their meaning
  kSpun,         ///< slip angle at the centre of gravity beyond 90 deg, it goes backwards
  kRolledOver,   ///< roll or pitch beyond 45 deg, where small angles are over
};
/// What the end of a drive is called in messages.
[[nodiscard]] std::string_view to_string(DriveEnd end);

/// A wheel that left the ground.
struct LiftOff {
  std::size_t wheel = 0;
  double from = 0.0, to = 0.0;  ///< [s]; `to` is the end of the simulation where it did not come back
};

/// The motion of a vehicle over time, a value a sample. Quantities that a model does not have are empty (the bicycle
/// has no vertical motion; its tyres of one axle carry equal forces). Axes ISO 8855.
struct VehicleTrajectory {
  DriveEnd end = DriveEnd::kCompleted;
  double end_time = 0.0;
  std::vector<LiftOff> lift_offs;

  std::vector<double> time;                        ///< [s]
  std::vector<double> x, y;                        ///< centre of gravity, earth axes [m]
  std::vector<double> yaw;                         ///< [rad]
  std::vector<double> u, v;                        ///< body velocities [m/s]
  std::vector<double> r;                           ///< yaw rate [rad/s]
  std::vector<double> yaw_acceleration;            ///< [rad/s^2]
  std::vector<double> longitudinal_acceleration;   ///< u' - r v, horizontal [m/s^2]
  std::vector<double> lateral_acceleration;        ///< v' + r u, horizontal [m/s^2]
  std::vector<double> steer;                       ///< [rad]
  std::vector<double> drive_torque, brake_torque;  ///< of all wheels together; empty where the speed is kept [N m]
  std::vector<double> roll, pitch;                 ///< left side up, nose down positive [rad]
  std::vector<double> heave;                       ///< of the sprung mass above its rest [m]
  std::vector<double> roll_rate, pitch_rate;       ///< [rad/s]
  std::vector<double> heave_rate;                  ///< [m/s]
  std::vector<double> roll_acceleration, pitch_acceleration;  ///< [rad/s^2]
  std::vector<double> heave_acceleration;                     ///< [m/s^2]
  PerWheel<std::vector<double>> slip_angle;                   ///< [rad]
  PerWheel<std::vector<double>> slip_ratio;
  PerWheel<std::vector<double>> Fx, Fy;             ///< wheel axes [N]
  PerWheel<std::vector<double>> Fz;                 ///< normal force, static load included [N]
  PerWheel<std::vector<double>> wheel_height;       ///< z_w, of the unsprung mass above its rest [m]
  PerWheel<std::vector<double>> suspension_travel;  ///< wheel_height less the body's corner: bump positive [m]
  PerWheel<std::vector<double>> road;               ///< height under the wheel [m]
  PerWheel<std::vector<double>> wheel_speed;        ///< [rad/s]

  [[nodiscard]] std::size_t size() const { return time.size(); }
  /// Whether the rows up to `end_time` mean something.
  [[nodiscard]] bool usable() const { return end != DriveEnd::kInterrupted && end != DriveEnd::kDiverged; }
  /// One sentence: how it ended, and which wheels left the ground.
  [[nodiscard]] std::string message() const;
};

}  // namespace veridyn::vehicle
