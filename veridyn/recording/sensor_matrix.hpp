#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/units.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::recording {

/// How a sensor of three axes reads what it measures, as another source knows it: reading = gain * truth + bias.
/// Diagonal of the gain: scale factors; off it: cross-sensitivity, which for small angles is misalignment.
struct SensorMatrix {
  Eigen::Matrix3d gain = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d gain_sigma = Eigen::Matrix3d::Zero();
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  ///< in the sensor's unit
  Eigen::Vector3d bias_sigma = Eigen::Vector3d::Zero();
  /// Of each axis, whether it moved enough to say anything of its gain. Of one that did not the gain is taken as 1.
  std::array<bool, 3> moved{true, true, true};
  double residual_rms = 0.0;  ///< what is left of the other source's signal
  double signal_rms = 0.0;    ///< of the other source's signal about its mean
  Eigen::Index rows = 0;

  [[nodiscard]] double unexplained() const { return residual_rms * residual_rms / (signal_rms * signal_rms); }
};

/// What a sensor is called, its axes, and the checks of its gain and bias.
struct SensorNames {
  std::string sensor;               ///< "accelerometer"
  std::string against;              ///< "velocity and attitude"
  std::array<std::string, 3> axes;  ///< {"x", "y", "z"}
  estimation::Check gain = {}, bias = {};
  double bias_unit = 1.0;  ///< that of the check, in the sensor's unit
  Unit unit = {};          ///< in which the sensor was taken to be recorded
};

/// Rows of a sensor's gain and bias, with what is wrong: axes that are swapped, a sign, a unit, a scale factor, a
/// misalignment; and one, not verified, of the axes that did not move.
[[nodiscard]] std::vector<estimation::Evidence> sensor_matrix_evidence(const SensorMatrix& matrix,
                                                                       const SensorNames& names);

/// The most conspicuous fault that a gain shows.
struct GainFault {
  estimation::Cause cause = estimation::Cause::kNone;
  std::string axes;  ///< "y and z"; of axes that are mixed "x reads minus y", of misaligned ones "x reads 0.1 z"
  double factor = 1.0, sigma = 0.0;  ///< reading over truth, of a unit or scale
  std::string unit = {};             ///< the two that were mistaken: "g taken for m/s^2"
};

/// Nothing where the gain is within the tolerance everywhere.
[[nodiscard]] std::optional<GainFault> gain_fault(const SensorMatrix& matrix, const SensorNames& names,
                                                  double tolerance);

}  // namespace veridyn::recording
