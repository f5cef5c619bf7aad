#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/aircraft/simulation/dryden.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/kalman/innovation.hpp"
#include "veridyn/estimation/kalman/innovation_guard.hpp"

namespace veridyn::aircraft {

/// Standard deviations (1 sigma) of white sensor errors per sample. The defaults are the specification's reference set,
/// whose table prints 2 sigma.
struct SensorSigma {
  double accelerometer = 0.05;         ///< m/s^2
  double gyro = 0.35 * kDegree;        ///< rad/s
  double attitude = 0.75 * kPi / 180;  ///< each Euler angle [rad]
  double velocity = 0.05;              ///< north and east [m/s]
  double velocity_down = 0.1;          ///< m/s
  double dynamic_pressure = 10.0;      ///< Pa
  double airspeed = 0.5;               ///< m/s
  double alpha = 0.6 * kDegree;        ///< rad
  double beta = 0.6 * kDegree;         ///< rad
};

/// Which filter delivers the motion through the air.
enum class FilterKind {
  kModelFree,   ///< kinematics only (AirDataModel)
  kModelBased,  ///< the subject's force coefficients are known (ModelBasedAirData)
  kGuarded,     ///< both; the model-based one while its innovations are as they should be (GuardedFilter)
  kNone         ///< none: airspeed and flow angles as recorded
};

[[nodiscard]] const char* to_string(FilterKind kind);

/// Where the white noise of the sensors is known from.
enum class NoiseSource {
  kMeasured,  ///< the noise floor of each channel, but not less than `autopilot_floor()`
  kReference  ///< SensorSigma's defaults, the specification's reference set
};

/// A gust spectrum that is assumed, and what it is called in messages: "low_light", or "study" for a table of numbers.
struct AssumedTurbulence {
  std::string name;
  DrydenSettings spectrum;
};

/// The spectrum of a named setting; see gust_spectrum.
[[nodiscard]] AssumedTurbulence named_turbulence(const std::string& setting);

/// How the motion through the air is reconstructed. Study table `[reconstruct]`.
struct ReconstructOptions {
  FilterKind filter = FilterKind::kModelFree;
  std::filesystem::path estimate_file;  ///< empty: the subject's values
  bool compare = true;
  std::array<double, 3> model_error{0.02, 0.005, 0.01};
  std::array<double, 3> model_error_walk{5e-4, 2e-4, 2e-4};
  estimation::GuardOptions guard;
  double rate_Hz = 0.0;  ///< 0: at the gyro's stamps
  NoiseSource sensors = NoiseSource::kMeasured;
  std::optional<AssumedTurbulence> turbulence = {};  ///< nothing: the spectrum of the largest innovation likelihood
  double turbulence_scale = 1.0;
  bool gyro_bias = false;
  bool accel_bias = false;
  bool gyro_scale = false;
  bool accel_scale = false;
  bool alpha_bias = false;
  bool beta_bias = false;
  bool alpha_scale = false;
  bool pitot_scale = false;
  bool pitot_bias = false;
  bool use_alpha = true;
  bool use_beta = true;
  bool use_pitot = true;
  bool airspeed_is_true = true;
  bool beta_is_flank = false;
  Eigen::Vector3d vane_position = Eigen::Vector3d::Zero();
  double wind_walk = 0.02;
  double wind_down_walk = 0.01;
  double initial_wind = 5.0;
  double initial_wind_down = 0.5;
  double min_airspeed = 3.0;
  double max_gap = 0.5;
  estimation::InnovationGate gate;
  /// Overrides `sensors`, units of SensorSigma.
  struct Sigma {
    std::optional<double> accelerometer, gyro, attitude, velocity, velocity_down, dynamic_pressure, airspeed, alpha,
        beta;
  } sigma;
  /// How late stamps are [s].
  struct Delay {
    double velocity = 0.0, attitude = 0.0, pitot = 0.0, alpha = 0.0, beta = 0.0;
  } delay;
  bool keep_innovations = false;
  bool keep_filter = true;  ///< whether the filter's estimate is kept in addition to the smoother's

  [[nodiscard]] static const KeyTable<ReconstructOptions>& keys();

  [[nodiscard]] bool estimates_imu_biases() const { return gyro_bias || accel_bias || estimates_imu_scales(); }
  [[nodiscard]] bool estimates_imu_scales() const { return gyro_scale || accel_scale; }
  [[nodiscard]] bool estimates_air_data_errors() const {
    return alpha_bias || beta_bias || alpha_scale || pitot_scale || pitot_bias;
  }
};

/// The least standard deviations that `sensors = "auto"` assumes of an ordinary autopilot. Attitude and velocity of its
/// filter, vibration and mounting errors are not white: what the samples scatter by is not how wrong they are.
/// Accelerometer 0.15 m/s^2, gyro 0.5 deg/s, attitude 2 deg, velocity 0.15 and 0.25 m/s, dynamic pressure 4 Pa,
/// airspeed 0.3 m/s, vanes 0.4 deg.
[[nodiscard]] SensorSigma autopilot_floor();

// What is assumed of sensor errors that are to be estimated, 1 sigma.
inline constexpr double kImuScalePrior = 0.05;           ///< scale factors of gyro and accelerometer
inline constexpr double kGyroBiasPrior = kDegree;        ///< rad/s
inline constexpr double kAccelBiasPrior = 0.5;           ///< m/s^2
inline constexpr double kVaneBiasPrior = 5.0 * kDegree;  ///< rad
inline constexpr double kAlphaScalePrior = 0.3;          ///< slope of the upwash
inline constexpr double kPitotScalePrior = 0.2;          ///< of the pressure
inline constexpr double kPitotBiasPrior = 20.0;          ///< Pa

/// A named setting of the specification's table, with its intensities times `scale`: "low_light", "low_moderate",
/// "medium_light", "medium_moderate", "none".
[[nodiscard]] DrydenSettings gust_spectrum(const std::string& setting, double scale = 1.0);

}  // namespace veridyn::aircraft
