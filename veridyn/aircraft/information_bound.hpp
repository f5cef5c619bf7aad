#pragma once

#include "veridyn/aircraft/dryden.hpp"

namespace veridyn::aircraft {

/// Root mean square errors [rad] that no estimator can undercut, filter and fixed-interval smoother.
struct AngleBound {
  double filter = 0.0;
  double smoother = 0.0;
};

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

}  // namespace veridyn::aircraft
