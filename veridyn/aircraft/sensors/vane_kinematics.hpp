#pragma once

#include <vector>

#include "veridyn/numerics/rotation.hpp"

namespace veridyn::aircraft {

/// What the angle of a vane follows from in still air, on one grid; NaN in holes and where the aircraft does not fly.
struct VaneKinematics {
  double rate_Hz = 1.0;
  std::vector<double> p, q, r;                        ///< [rad/s]
  std::vector<double> ax, ay, az;                     ///< specific force [m/s^2]
  std::vector<double> phi, theta;                     ///< [rad]
  std::vector<double> Va;                             ///< [m/s]
  std::vector<double> alpha, beta;                    ///< only enter through their sine and cosine [rad]
  numerics::Vector3<double> position{0.0, 0.0, 0.0};  ///< of the vanes from the centre of gravity, body axes [m]
};

/// The angles that vanes at `position` show in still air.
struct StillAirAngles {
  std::vector<double> alpha, beta;
};

/// Integrals of `still_air_rate` and what rotation adds at the vanes, with `airspeed_factor` times the airspeed. Each
/// stretch between holes begins at zero, and drifts with the sensors' errors: compare it `without_drift`.
[[nodiscard]] StillAirAngles still_air_angles(const VaneKinematics& motion, double airspeed_factor = 1.0);

/// The angle less its mean over two seconds: what biases, scales and slow drift leave alone, from about 0.3 Hz on. NaN
/// within a second of holes and ends.
[[nodiscard]] std::vector<double> without_drift(const std::vector<double>& angle, double rate_Hz);

}  // namespace veridyn::aircraft
