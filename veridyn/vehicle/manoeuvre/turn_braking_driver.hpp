#pragma once

#include <memory>

#include "veridyn/vehicle/model/driver.hpp"

namespace veridyn::vehicle {

/// What a driver does who brakes in a turn.
struct TurnBrakingOptions {
  double brake_time = 15.0;   ///< when the pedal begins to move [s]
  double brake_torque = 0.0;  ///< of all wheels, from the end of the ramp on [N m]
  double rise_time = 0.2;     ///< of the ramp [s]
};

/// Drives as another until he brakes: from then on the steering is held as it is, and the drive torque is gone.
class TurnBrakingDriver : public Driver {
 public:
  /// @throws InputError("driver", ...) for times and torques that are not > 0.
  TurnBrakingDriver(std::unique_ptr<Driver> before, const TurnBrakingOptions& options);

  void look(double time, const PlanarMotion& motion) override;
  [[nodiscard]] Controls controls(double time) const override;

 private:
  std::unique_ptr<Driver> before_;
  TurnBrakingOptions options_;
};

}  // namespace veridyn::vehicle
