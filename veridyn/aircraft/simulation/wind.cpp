#include "veridyn/aircraft/simulation/wind.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/study_keys.hpp"

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

const KeyTable<WindSettings>& WindSettings::keys() {
  using W = WindSettings;
  static const auto table =
      KeyTable<W>("flight")
          .numbers("wind", &W::mean, "m/s", kAnyNumber, "where the air moves to: north, east, down")
          .number("wind_shear", &W::shear_exponent, "1", kAnyNumber,
                  "exponent of the power law by which wind grows with height; 0: none, 1/7 over open land")
          .number("wind_shear_reference", &W::shear_reference, "m", kPositive, "height above ground where `wind` holds")
          .number("wind_drift", &W::drift_sigma, "m/s", kNotNegative,
                  "slow random change, standard deviation of each horizontal component")
          .number("wind_drift_time", &W::drift_time, "s", kPositive, "its correlation time");
  return table;
}

}  // namespace veridyn::aircraft
