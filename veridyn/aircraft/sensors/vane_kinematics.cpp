// Angles of vanes by integration of what inertial sensors measure.
#include "veridyn/aircraft/sensors/vane_kinematics.hpp"

#include <cmath>
#include <cstddef>
#include <utility>

#include "veridyn/aircraft/model/air_data.hpp"
#include "veridyn/aircraft/model/still_air_rate.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/filters.hpp"

namespace veridyn::aircraft {

StillAirAngles still_air_angles(const VaneKinematics& motion, double airspeed_factor) {
  const std::size_t n = motion.Va.size();
  StillAirAngles angles{.alpha = std::vector<double>(n, kNaN), .beta = std::vector<double>(n, kNaN)};
  const double half_step = 0.5 / motion.rate_Hz;
  double alpha = 0.0, beta = 0.0;
  WindAxesRate<double> last{.Va = kNaN, .alpha = kNaN, .beta = kNaN};
  for (std::size_t k = 0; k < n; ++k) {
    const InertialMoment now{.specific_force = {motion.ax[k], motion.ay[k], motion.az[k]},
                             .rates = {motion.p[k], motion.q[k], motion.r[k]},
                             .phi = motion.phi[k],
                             .theta = motion.theta[k],
                             .Va = airspeed_factor * motion.Va[k],
                             .alpha = motion.alpha[k],
                             .beta = motion.beta[k]};
    const WindAxesRate<double> rate = still_air_rate(now);
    const bool known = std::isfinite(rate.alpha) && std::isfinite(rate.beta);
    const WindAxesRate<double> before = std::exchange(last, rate);
    if (!known) continue;
    const bool goes_on = std::isfinite(before.alpha) && std::isfinite(before.beta);
    alpha = goes_on ? alpha + half_step * (before.alpha + rate.alpha) : 0.0;
    beta = goes_on ? beta + half_step * (before.beta + rate.beta) : 0.0;
    const AirData<double> there = air_data<double>(air_velocity(now.Va, now.alpha, now.beta) +
                                                   numerics::Vector3<double>(now.rates.cross(motion.position)));
    angles.alpha[k] = alpha + there.alpha - now.alpha;
    angles.beta[k] = beta + there.beta - now.beta;
  }
  return angles;
}

std::vector<double> without_drift(const std::vector<double>& angle, double rate_Hz) {
  constexpr double kMean_s = 2.0;
  const auto half = static_cast<std::size_t>(std::lround(0.5 * kMean_s * rate_Hz));
  numerics::FirKernel kernel{.taps = std::vector<double>(2 * half + 1, -1.0 / static_cast<double>(2 * half + 1)),
                             .rate_Hz = rate_Hz};
  kernel.taps[half] += 1.0;
  return numerics::filter(angle, kernel, numerics::Edges::kNan);
}

}  // namespace veridyn::aircraft
