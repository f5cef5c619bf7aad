#include "veridyn/aircraft/simulation/wind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace veridyn::aircraft {

Wind::Wind(const WindSettings& settings, numerics::RandomStream random) : settings_(settings), random_(random) {}

void Wind::advance(double step) {
  if (settings_.drift_sigma == 0.0) return;
  const double theta = step / settings_.drift_time;
  const double noise = settings_.drift_sigma * std::sqrt(-std::expm1(-2.0 * theta));
  for (Eigen::Index i = 0; i < 2; ++i) drift_(i) = std::exp(-theta) * drift_(i) + noise * random_.normal();
}

Eigen::Vector3d Wind::at(double height) const {
  Eigen::Vector3d wind = settings_.mean;
  if (settings_.shear_exponent != 0.0) {
    wind *= std::pow(std::max(height, 0.1) / settings_.shear_reference, settings_.shear_exponent);
  }
  wind.head<2>() += drift_;
  return wind;
}

WindSettings read_wind(const StudyTable& flight) {
  WindSettings w;
  if (flight.has("wind")) {
    const std::vector<double> mean = flight.numbers("wind", "m/s");
    if (mean.size() != 3) {
      flight.fail("wind", fmt::format("has {} numbers, expected 3: [north, east, down]", mean.size()));
    }
    w.mean = {mean[0], mean[1], mean[2]};
  }
  w.shear_exponent = flight.number_or("wind_shear", "1", 0.0);
  w.shear_reference = flight.positive_or("wind_shear_reference", "m", w.shear_reference);
  w.drift_sigma = flight.number_or("wind_drift", "m/s", 0.0);
  if (!(w.drift_sigma >= 0.0)) flight.fail("wind_drift", fmt::format("= {:g} must be >= 0", w.drift_sigma));
  w.drift_time = flight.positive_or("wind_drift_time", "s", w.drift_time);
  return w;
}

}  // namespace veridyn::aircraft
