#pragma once

#include <memory>

#include "veridyn/vehicle/model/vehicle.hpp"
#include "veridyn/vehicle/simulation/stepped_drive.hpp"

namespace veridyn::vehicle {

/// A `SteppedDrive` whatever its tyres: its functions are that one's.
class SteppedVehicle {
 public:
  virtual ~SteppedVehicle() = default;
  virtual void reset(double speed) = 0;
  virtual void reset(const DriveState& state) = 0;
  virtual void step(const Controls& controls, double dt) noexcept = 0;
  [[nodiscard]] virtual const DriveState& state() const = 0;
  [[nodiscard]] virtual recording::MotionSample motion(const Eigen::Vector3d& place) const = 0;
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
