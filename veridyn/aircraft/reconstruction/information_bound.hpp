#pragma once

#include <string>

#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/aircraft/simulation/dryden.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {

/// Root mean square errors [rad] that no estimator can undercut, filter and fixed-interval smoother.
struct AngleBound {
  double filter = 0.0;
  double smoother = 0.0;
};

/// The bounds of both flow angles.
struct InformationBound {
  AngleBound alpha;
  AngleBound beta;
};

/// How well alpha and beta can be known by someone who does not know the aircraft.
///
/// Attitude, ground velocity and slow wind are taken as exact, so only the gusts are unknown: w = Va alpha with
/// Dryden's vertical spectrum, v = Va beta with its lateral one, in level flight at constant airspeed. A vane sees each
/// with white error of standard deviation `vane_sigma` [rad] at `rate_Hz`. The bound is the stationary covariance of
/// the discrete Riccati equation of the two gust states with this one measurement (filter: after the measurement), and
/// of its backward adjoint (smoother: far from both ends). The pitot tube adds nothing: to first order it does not see
/// v and w. Gaussian and linear, so the bound is attained.
///
/// Reproduces the specification's values with the reference vanes (2 sigma = 1.2 deg, 100 Hz): low altitude, moderate,
/// 15 m/s: alpha 0.4485 / 0.3744 deg, beta 0.4099 / 0.3313 deg.
[[nodiscard]] InformationBound information_bound(const DrydenSettings& spectrum, double airspeed, double vane_sigma,
                                                 double rate_Hz);

/// White errors of one sample, 1 sigma, and how many samples there are a second.
struct BoundSensors {
  double alpha = 0.6 * kDegree;    ///< vane [rad]; 0: there is none
  double beta = 0.6 * kDegree;     ///< vane [rad]; 0: there is none
  double accelerometer = 0.05;     ///< [m/s^2]
  double dynamic_pressure = 10.0;  ///< [Pa]; 0: there is no pitot tube
  double rate_Hz = 100.0;
  /// Takes the airspeed as known (no longitudinal gust, measurements at constant airspeed), as the specification's
  /// figures do. A filter does not know it: the force
  /// changes with the airspeed too, and what of a change of force is alpha is then less certain.
  bool airspeed_known = false;
  /// Whether the accelerometer along x counts; the specification's figures leave it out.
  bool axial_force = true;
};

/// The bound of who knows the aircraft.
struct ModelBound {
  InformationBound angles;
  AngleBound airspeed;      ///< [m/s]
  double trim_alpha = 0.0;  ///< where it was linearised [rad]
  bool usable = false;      ///< false: the aircraft does not fly level at that airspeed
};

/// How well alpha, beta and airspeed can be known when the aircraft's derivatives are known: as above
/// (attitude, ground velocity and slow wind exact; Dryden's gusts along the three axes unknown), with an accelerometer
/// that measures the force of the subject's model, linearised about steady level flight at `airspeed` and
/// `air_density`. Where the subject's moments and inertia give no complete trim, alpha and thrust are those of balanced
/// forces with undeflected controls.
///
/// With `airspeed_known` and without `axial_force` it reproduces the specification's values for UnATRaP in low-altitude
/// moderate turbulence with the reference sensors: at 15 m/s alpha 0.08 / 0.08 deg (0.075 / 0.074 here, drag counted in
/// the normal force), beta 0.28 / 0.24 deg; at 20 m/s 0.04 / 0.04 and 0.19 / 0.17 deg (filter / smoother). With the
/// airspeed unknown, as it is, alpha's are 0.17 / 0.14 and 0.09 / 0.07 deg. Beyond the linear range (stall) the
/// aircraft gives less than this.
[[nodiscard]] ModelBound information_bound(const DrydenSettings& spectrum, const Subject& subject, double airspeed,
                                           const BoundSensors& sensors, double air_density = 1.225);

}  // namespace veridyn::aircraft
