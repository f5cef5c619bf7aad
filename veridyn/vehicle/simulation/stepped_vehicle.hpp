#pragma once

#include <memory>

#include "veridyn/vehicle/model/vehicle.hpp"
#include "veridyn/vehicle/simulation/stepped_drive.hpp"

namespace veridyn::vehicle {

/// Where a vehicle is in the world and how it moves there, z up.
struct WorldMotion {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of the centre of gravity, less its height at rest [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< [m/s]
};

/// A `SteppedDrive` whatever its tyres: its functions are that one's.
class SteppedVehicle {
 public:
  virtual ~SteppedVehicle() = default;
  virtual void reset(double speed) = 0;
  virtual void reset(const DriveState& state) = 0;
  virtual void reset(const DriveState& state, const Eigen::Vector3d& field, const Eigen::Vector2d& turning) = 0;
  virtual void step(const Controls& controls, double dt) noexcept = 0;
  [[nodiscard]] virtual const DriveState& state() const = 0;
  [[nodiscard]] virtual recording::MotionSample motion(const Eigen::Vector3d& place) const = 0;
  [[nodiscard]] virtual WorldMotion world() const = 0;
  /// Loads of the tyres [N].
  [[nodiscard]] virtual const WheelArray<double>& loads() const = 0;
  [[nodiscard]] virtual std::unique_ptr<SteppedVehicle> clone() const = 0;

 protected:
  SteppedVehicle() = default;
  SteppedVehicle(const SteppedVehicle&) = default;
  SteppedVehicle& operator=(const SteppedVehicle&) = default;
};

/// The vehicle on four wheels, to be stepped. @throws InputError as the constructor of `SteppedDrive`.
[[nodiscard]] std::unique_ptr<SteppedVehicle> stepped_vehicle(const Vehicle& vehicle, const FourWheelOptions& options,
                                                              std::shared_ptr<const Road> road = nullptr,
                                                              double usual_speed = 20.0);

}  // namespace veridyn::vehicle
