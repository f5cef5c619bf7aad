#include "veridyn/aircraft/identification/signals/air_rates.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/linear_systems/washout.hpp"
#include "veridyn/recording/grid_signals.hpp"

namespace veridyn::aircraft {
namespace {

/// x less its lag over `length` of the path, over that length: dx/ds of slow changes.
std::vector<double> slope_along(const std::vector<double>& x, const std::vector<double>& airspeed, double step,
                                double length) {
  std::vector<double> slope(x.size(), 0.0);
  double held = 0.0;
  for (std::size_t k = 1; k < x.size(); ++k) {
    const bool known = std::isfinite(x[k]) && std::isfinite(x[k - 1]) && std::isfinite(airspeed[k]);
    held = known ? numerics::washed_out(held, x[k] - x[k - 1], step * airspeed[k] / length) : 0.0;
    slope[k] = held / length;
  }
  return slope;
}

}  // namespace

FlightSample<double> AirRates::against_air(FlightSample<double> sample, std::size_t k) const {
  using F = FlightSignal;
  if (gust_q.empty()) return sample;
  sample[F::kQ] += pitch_share * gust_q[k] + downwash_share * downwash_q[k];
  sample[F::kR] += yaw_share * gust_r[k];
  return sample;
}

AirRates air_rates(const Recording& smoothed, const numerics::UniformGrid& grid, const std::vector<double>& airspeed,
                   const numerics::FirKernel& smooth, const Subject& subject) {
  AirRates rates;
  if (!smoothed.has("gust_y") || !smoothed.has("gust_z") || !smoothed.has("alpha") || !(subject.span > 0.0))
    return rates;
  constexpr double kTailChords = 3.0;
  const auto on_grid = [&](const char* name) { return recording::on_grid(smoothed.at(name), grid); };
  const std::vector<double> v = on_grid("gust_y"), w = on_grid("gust_z"), alpha = on_grid("alpha");
  rates.gust_q = slope_along(w, airspeed, grid.step, 4.0 * subject.span / kPi);
  rates.gust_r = slope_along(v, airspeed, grid.step, 3.0 * subject.span / kPi);
  for (double& r : rates.gust_r) r = -r;
  // alpha' of the tail, less alpha' without the gusts' own: alpha_g = -w_g/V.
  rates.downwash_q = slope_along(alpha, airspeed, grid.step, kTailChords * subject.chord);
  for (std::size_t k = 0; k < grid.count; ++k) {
    const std::size_t before = k > 0 ? k - 1 : 0, after = std::min(k + 1, grid.count - 1);
    const double h = grid.step * static_cast<double>(after - before);
    const double still = (alpha[after] - alpha[before]) / h + (w[after] - w[before]) / (h * airspeed[k]);
    const double late = rates.downwash_q[k] * airspeed[k] - still;
    rates.downwash_q[k] = std::isfinite(late) ? late : 0.0;
  }
  for (std::vector<double>* rate : {&rates.gust_q, &rates.gust_r, &rates.downwash_q})
    *rate = numerics::filter(*rate, smooth);
  return rates;
}

}  // namespace veridyn::aircraft
