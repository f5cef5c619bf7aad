#pragma once

#include <Eigen/Core>
#include <string>

#include "veridyn/aircraft/model/atmosphere.hpp"
#include "veridyn/aircraft/model/flight_dynamics.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {

/// The desired steady level flight: straight, or a turn of given bank at constant height.
struct TrimCondition {
  double airspeed = 20.0;             ///< [m/s]
  double density = kSeaLevelDensity;  ///< [kg/m^3]
  double bank = 0.0;                  ///< [rad]; the turn rate is g tan(bank) / Va
  double gravity = kGravity;          ///< [m/s^2]
};

/// How the search for a trim ended.
enum class TrimEnd {
  kConverged,   ///< every acceleration is below 1e-9 (m/s^2, rad/s^2)
  kNoSolution,  ///< Newton's method stopped above that: the aircraft cannot fly steadily there
  kLimits,      ///< balanced, but with a deflection or throttle beyond its stop
};

/// The steady state found, or the closest one.
struct Trim {
  TrimCondition condition;
  double alpha = 0.0, beta = 0.0, theta = 0.0;  ///< [rad]
  Controls<double> controls;
  Eigen::Vector3d rates = Eigen::Vector3d::Zero();  ///< body rates [rad/s]
  double residual = 0.0;                            ///< largest acceleration left [m/s^2 or rad/s^2]
  int iterations = 0;
  TrimEnd end = TrimEnd::kNoSolution;
  [[nodiscard]] bool usable() const { return end == TrimEnd::kConverged; }
  [[nodiscard]] std::string message() const;
};

/// Finds steady level flight: alpha, beta, elevator, aileron, rudder and throttle such that no acceleration is left, by
/// Newton's method with derivatives from automatic differentiation. Where a control has no effect (an aircraft without
/// rudder) the step of least norm is taken; such an aircraft may not have a turn of exactly that rate. The subject must
/// have inertia and a complete model.
[[nodiscard]] Trim find_trim(const Subject& subject, const TrimCondition& condition);

/// Small motions about a trim: x' = A x + B u with x = [u v w p q r phi theta] (air-relative velocity in body axes
/// [m/s], rates [rad/s], angles [rad]) and u = [de da dr throttle].
struct LinearModel {
  Eigen::Matrix<double, 8, 8> A;
  Eigen::Matrix<double, 8, 4> B;
};

/// Derivatives at a trim by automatic differentiation; a rotor is taken to follow the throttle at once, density not to
/// change with height.
[[nodiscard]] LinearModel linearise(const Subject& subject, const Trim& trim);

}  // namespace veridyn::aircraft
