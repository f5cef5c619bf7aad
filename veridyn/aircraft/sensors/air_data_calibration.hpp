#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "veridyn/aircraft/sensors/channel_map.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/estimation/result/estimate.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::aircraft {

/// What one sensor reads against the truth: raw = bias + scale true. Of a vane the scale is the upwash slope: at the
/// nose or wing it turns by more than the angle of attack.
struct SensorCalibration {
  std::string channel;  ///< standard name: dynamic_pressure, static_pressure, air_temperature, alpha, beta, airspeed
  double scale = 1.0;
  double bias = 0.0;                                     ///< SI unit of the raw reading
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of [scale, bias]
  double raw_low = 0.0, raw_high = 0.0;                  ///< range of the calibration
  double residual_rms = 0.0;                             ///< in units of the true quantity: what a straight line leaves

  [[nodiscard]] double corrected(double raw) const { return (raw - bias) / scale; }
  /// Standard deviation of `corrected` by the errors of scale and bias, and, when `with_residual`, what the straight
  /// line leaves.
  [[nodiscard]] double sigma(double raw, bool with_residual = true) const;
};

/// A file of calibrations: a table for each channel with `scale`, `bias`, `covariance` (of [scale, bias]), `range`
/// (raw) and `residual_rms`, SI and radians.
[[nodiscard]] std::vector<SensorCalibration> read_calibration(const std::filesystem::path& path);
/// The file that `read_calibration` reads.
[[nodiscard]] std::string calibration_toml(const std::vector<SensorCalibration>& sensors, const std::string& origin);

/// Corrects the channels of a mapped recording, and says so in its origins and notes; a channel that is missing, or
/// outside the calibrated range for more than 1 % of its samples, is noted.
void apply_calibration(const std::vector<SensorCalibration>& sensors, MappedRecording& mapped);

/// One sensor of a wind-tunnel run. Study table `[calibration.CHANNEL]`.
struct CalibrationInput {
  std::string channel;
  std::string raw, reference;  ///< columns
  std::string reference_speed, static_pressure, air_temperature;
  double air_density = 0.0;
  double sigma_raw = 0.0, sigma_reference = 0.0;
};

/// From wind-tunnel points to calibrations. Study table `[calibration]`.
struct CalibrationStudy {
  std::string name = "air data";
  std::filesystem::path file;
  std::vector<CalibrationInput> sensors;
  [[nodiscard]] static const KeyTable<CalibrationStudy>& keys();
};

/// Fit of one sensor and what the residual says about it.
struct SensorFit {
  SensorCalibration calibration;
  std::string unit;  ///< of the true quantity, SI
  estimation::Method method = estimation::Method::kOls;
  bool bias_only = false;                        ///< the points do not determine a scale: it is 1
  std::vector<double> reference, raw, residual;  ///< residual = corrected - reference, in the order of the points
  std::vector<int> direction;                    ///< +1 reference rising, -1 falling, 0 neither
  double rms = 0.0, worst = 0.0;
  std::size_t worst_point = 0;  ///< row, from 1
  numerics::WhitenessTest whiteness;
  double hysteresis = 0.0, hysteresis_sigma = 0.0;  ///< rising less falling, NaN when the points go one way only
  double quadratic = 0.0, quadratic_p = 1.0;        ///< coefficient of reference^2 in raw, and its p-value
  double bend = 0.0;                                ///< what the quadratic term amounts to at the ends, true quantity
  double error_ratio = 0.0;  ///< residual variance over what the stated errors explain; 0 when they are not stated
  std::vector<std::string> findings;  ///< in words, what is not as a straight line with white noise
  bool usable = false;
};

/// "OLS", or "GTLS (bias only)".
[[nodiscard]] std::string method_text(const SensorFit& fit);

/// Fits of all sensors of a calibration.
struct CalibrationResult {
  std::vector<SensorFit> sensors;
  estimation::Estimate estimate;
};

/// @throws InputError for an unreadable table, missing columns, or fewer than 4 points of a sensor.
[[nodiscard]] CalibrationResult calibrate(const CalibrationStudy& study);

/// channel, point, reference, raw, residual, direction.
[[nodiscard]] std::string residuals_csv(const CalibrationResult& result);

}  // namespace veridyn::aircraft
