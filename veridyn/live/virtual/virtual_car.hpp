#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "veridyn/live/teleoperation/car_end.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/vehicle/road/road_surface.hpp"
#include "veridyn/vehicle/simulation/stepped_vehicle.hpp"

namespace veridyn::live {

/// How wrong the sensors of a virtual car are: white noise of each report, and biases drawn once, both as standard
/// deviations. Of the order of small MEMS sensors at 100 Hz, wheel encoders and a potentiometer at the steering.
struct CarSensorErrors {
  double acceleration = 0.05, acceleration_bias = 0.05;  ///< [m/s^2]
  double rate = 0.003, rate_bias = 0.002;                ///< [rad/s]
  double steering = 0.001, steering_bias = 0.001;        ///< of the road wheels [rad]
  double wheel_speed = 0.05;                             ///< [rad/s]
};

struct VirtualCarOptions {
  CarEndOptions end;
  double brake_torque = 3.0;                         ///< of the brake fully on, all wheels together [N m]
  double steering_lag = 0.03;                        ///< time constant of the steering servo [s]
  Eigen::Vector3d sensor = Eigen::Vector3d::Zero();  ///< of the inertial sensors from the centre of gravity, flu [m]
  CarSensorErrors errors;
  double battery = 11.1;  ///< [V]
  std::uint64_t seed = 1;

  /// @throws InputError naming the option
  void validate() const;
};

/// A scaled car without hardware at the far end of a serial line: bytes in, bytes out, each with its time, and between
/// them the four-wheel model in steps of 1 ms, from rest and in both directions. Knows nothing of clocks and lines: the
/// same bytes at the same times give the same states, bit for bit.
class VirtualCar {
 public:
  static constexpr Nanoseconds kStep = kMillisecond;
  /// How much is caught up at once after the program was held up; the rest is left out.
  static constexpr Nanoseconds kLongestHoldUp = kSecond;

  /// @param run another number after each start @throws InputError as the options, and for a vehicle that cannot be
  /// stepped
  /// @param surface on which it drives; null: a level road
  VirtualCar(const vehicle::Vehicle& vehicle, const VirtualCarOptions& options, std::uint16_t run,
             std::shared_ptr<const vehicle::RoadSurface> surface = nullptr);

  /// Takes bytes of the line. @param now of the car's clock, as in every function here never going back
  void receive(Bytes bytes, Nanoseconds now);
  /// Drives on to that time. The first call sets the beginning.
  void advance(Nanoseconds now);
  /// The next report: sensors as they are now, with their errors. @return bytes written, see `CarEnd::report`
  std::size_t report(Nanoseconds now, std::span<std::uint8_t> out);

  /// Without errors of sensors.
  [[nodiscard]] const vehicle::DriveState& state() const { return vehicle_->state(); }
  [[nodiscard]] recording::MotionSample motion() const { return vehicle_->motion(options_.sensor); }
  /// Where it is in the world, z up.
  [[nodiscard]] vehicle::WorldMotion world() const { return vehicle_->world(); }
  [[nodiscard]] CarSensors true_sensors() const;
  [[nodiscard]] const CarActuation& actuation() const { return actuation_; }
  [[nodiscard]] const CarEnd& end() const { return end_; }

 private:
  VirtualCarOptions options_;
  double wheel_radius_;
  std::unique_ptr<vehicle::SteppedVehicle> vehicle_;
  CarEnd end_;
  CarActuation actuation_;
  double steer_ = 0.0;
  std::optional<Nanoseconds> time_;
  numerics::RandomStream random_;
  CarSensors bias_;
};

/// What really happened, row by row, as our CSV in frame flu: time, pos_x|y|z, roll, pitch, yaw, speed,
/// lateral_velocity, yaw_rate, accel_x|y|z at the sensor (gravity in), steer, drive_torque, brake_torque, state (of
/// `CarState`). Attitude against the world. Rows 100 times a second.
class CarTruth {
 public:
  void add(Nanoseconds time, const VirtualCar& car);
  [[nodiscard]] std::string csv() const;
  [[nodiscard]] bool empty() const { return rows_.empty(); }

 private:
  struct Row {
    std::array<double, 17> values;
  };
  std::vector<Row> rows_;
};

}  // namespace veridyn::live
