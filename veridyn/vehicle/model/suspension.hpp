#pragma once

#include <string>

#include "veridyn/vehicle/model/spring_curve.hpp"

namespace veridyn::vehicle {

/// How an axle guides its wheels, and its spring where that is a table. By default the body rolls about the ground and
/// wheels steer only as ordered. Equations: docs/vehicle.md, "Suspension geometry".
struct AxleSuspension {
  /// h, height of the roll centre above the road at rest [m]: the links carry the axle's lateral force to the body
  /// there, so that h F_Y is transferred between the tyres without rolling the body.
  double roll_centre = 0.0;
  /// Steer of both wheels per roll of the body against the axle, left positive [rad/rad]. In a left turn that roll is
  /// positive: positive oversteers in front and understeers behind.
  double roll_steer = 0.0;
  /// Toe-in of each wheel per travel in bump [rad/m]; over a track W it acts in roll as a roll steer of W/2 times it.
  double bump_steer = 0.0;
  /// Steer of a wheel per lateral force of its tyre, with it positive [rad/N]: negative understeers in front, positive
  /// behind.
  double compliance_steer = 0.0;
  /// Takes the place of the constant rate K_s where it is not empty.
  SpringCurve spring{};

  /// Whether wheels steer by roll, travel or force.
  [[nodiscard]] bool steers() const { return roll_steer != 0.0 || bump_steer != 0.0 || compliance_steer != 0.0; }
};

/// What the air pushes up on the axles at speed u: 1/2 rho (C_L A) u^2. Drag belongs to `LongitudinalParameters`.
struct AerodynamicLift {
  double area_f = 0.0;         ///< C_L A at the front axle [m^2]: upward positive
  double area_r = 0.0;         ///< at the rear axle
  double air_density = 1.225;  ///< rho [kg/m^3]

  [[nodiscard]] bool acts() const { return area_f != 0.0 || area_r != 0.0; }
};

/// Why no axle can be like that, naming the number with its suffix ("roll_centre_f is ..."); empty when all is well.
[[nodiscard]] std::string inadmissible(const AxleSuspension& axle, char suffix);
/// The same for the air.
[[nodiscard]] std::string inadmissible(const AerodynamicLift& lift);

}  // namespace veridyn::vehicle
