#pragma once

#include <Eigen/Core>

#include "veridyn/core/study.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {

/// The mean wind: constant, with height by a power law, and with a slow random drift of its horizontal components. Keys
/// of the study table `[flight]`.
struct WindSettings {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();  ///< where the air moves to: north, east, down [m/s]
  double shear_exponent = 0.0;                     ///< wind grows with (height / reference)^exponent
  double shear_reference = 10.0;                   ///< [m]
  double drift_sigma = 0.0;                        ///< [m/s]
  double drift_time = 120.0;                       ///< [s]

  [[nodiscard]] static const KeyTable<WindSettings>& keys();
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

}  // namespace veridyn::aircraft
