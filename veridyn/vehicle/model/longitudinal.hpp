#pragma once

#include <string>

namespace veridyn::vehicle {

/// What drives, brakes and resists a vehicle along its way, for models with longitudinal dynamics. Constant numbers;
/// the torques themselves come from the driver (`Controls`).
///
/// Both axles have open differentials: left and right wheel of an axle get the same torque. Drag acts at the centre of
/// gravity, 1/2 rho C_d A u|u|; rolling resistance is a moment f_r F_z R on each wheel. The grade is that of the road
/// along the vehicle's heading, wherever it heads: positive uphill.
struct LongitudinalParameters {
  double front_drive_share = 0.0;    ///< of the drive torque, 0 (rear wheels driven) to 1 (front)
  double front_brake_share = 0.6;    ///< of the brake torque, 0 to 1
  double wheel_radius = 0.30;        ///< R, effective, also the arm of the longitudinal force [m]
  double wheel_inertia = 1.0;        ///< I_w, spin inertia of one wheel with what turns with it [kg m^2]
  double drag_area = 0.65;           ///< C_d A [m^2]
  double air_density = 1.225;        ///< rho [kg/m^3]
  double rolling_resistance = 0.01;  ///< f_r, per normal force
  double grade = 0.0;                ///< slope of the road along the heading, uphill positive [rad]
};

/// Why no vehicle can have these numbers, naming the number, its value and its rule; empty when all is well.
[[nodiscard]] std::string inadmissible(const LongitudinalParameters& parameters);

}  // namespace veridyn::vehicle
