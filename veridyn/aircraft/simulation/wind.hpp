#pragma once

#include <Eigen/Core>

#include "veridyn/core/study.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {

/// The mean wind: constant, with height by a power law, and with a slow random drift of its horizontal components.
struct WindSettings {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();  ///< where the air moves to: north, east, down [m/s]
  double shear_exponent = 0.0;    ///< wind grows with (height / reference)^exponent; 0: none, 1/7 over open land
  double shear_reference = 10.0;  ///< height above ground where the mean holds [m]
  double drift_sigma = 0.0;       ///< standard deviation of the drift, each component [m/s]
  double drift_time = 120.0;      ///< its correlation time [s]
};

/// The mean wind along a flight. The drift is a Gauss-Markov process, exactly discretised, that starts at zero.
class Wind {
 public:
  Wind(const WindSettings& settings, numerics::RandomStream random);
  void advance(double step);
  /// [m/s], NED, at a height above ground [m].
  [[nodiscard]] Eigen::Vector3d at(double height) const;

 private:
  WindSettings settings_;
  numerics::RandomStream random_;
  Eigen::Vector2d drift_ = Eigen::Vector2d::Zero();
};

/// Reads wind keys of a `[flight]` table: `wind = [n, e, d]` [m/s], `wind_shear` (exponent), `wind_shear_reference`
/// [m], `wind_drift` [m/s], `wind_drift_time` [s].
[[nodiscard]] WindSettings read_wind(const StudyTable& flight);

}  // namespace veridyn::aircraft
