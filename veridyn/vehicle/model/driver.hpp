#pragma once

namespace veridyn::vehicle {

/// Where a vehicle is on the plane and how it moves: earth axes x, y (heading psi counted from x, left positive), body
/// velocities of the centre of gravity.
struct PlanarMotion {
  double x = 0.0, y = 0.0;  ///< [m]
  double yaw = 0.0;         ///< psi [rad], not wrapped
  double u = 0.0, v = 0.0;  ///< forward, leftward [m/s]
  double r = 0.0;           ///< yaw rate [rad/s]
};

/// What the driver does.
struct Controls {
  double steer = 0.0;         ///< delta, at the road wheels of the front axle, left positive [rad]
  double drive_torque = 0.0;  ///< of all driven wheels together [N m]
  double brake_torque = 0.0;  ///< of all wheels together, >= 0 [N m]
};

/// What drives a vehicle: a recorded signal, a manoeuvre, a driver model.
class Driver {
 public:
  virtual ~Driver() = default;
  /// Called once at the beginning of every integration step: closed-loop drivers decide here.
  virtual void look(double /*time*/, const PlanarMotion& /*motion*/) {}
  /// Controls at a time within that step. Called at its beginning, middle and end; must be continuous within it.
  [[nodiscard]] virtual Controls controls(double time) const = 0;
};

}  // namespace veridyn::vehicle
