#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/estimation/judgement/evidence.hpp"

namespace veridyn::recording {

/// How a sensor of three axes reads what it measures, as another source knows it: reading = gain * truth + bias.
/// Diagonal of the gain: scale factors; off it: cross-sensitivity, which for small angles is misalignment.
struct SensorMatrix {
  Eigen::Matrix3d gain = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d gain_sigma = Eigen::Matrix3d::Zero();
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  ///< in the sensor's unit
  Eigen::Vector3d bias_sigma = Eigen::Vector3d::Zero();
  double residual_rms = 0.0;  ///< what is left of the other source's signal
  double signal_rms = 0.0;    ///< of the other source's signal about its mean
  Eigen::Index rows = 0;

  [[nodiscard]] double unexplained() const { return residual_rms * residual_rms / (signal_rms * signal_rms); }
};

/// How good a sensor's gain and bias must be.
struct SensorTolerance {
  double gain_care = 0.02;    ///< beyond three standard errors: with care
  double gain_failed = 0.15;  ///< and failed
  double bias_care = 0.0;     ///< in the unit of the bias
  double bias_failed = 0.0;
};

/// What a sensor is called, and its axes and unit, in messages.
struct SensorNames {
  std::string sensor;               ///< "accelerometer"
  std::string against;              ///< "velocity and attitude"
  std::array<std::string, 3> axes;  ///< {"x", "y", "z"}
  std::string unit;                 ///< of the bias
};

/// Rows "gain of the accelerometer" and "bias of the accelerometer", with the fault in the words of the trade: axes
/// that are swapped, a sign, a unit, a scale factor, a misalignment.
[[nodiscard]] std::vector<estimation::Evidence> sensor_matrix_evidence(const SensorMatrix& matrix,
                                                                       const SensorNames& names,
                                                                       const SensorTolerance& tolerance);

/// The most conspicuous fault that a gain shows, in words; nothing where it is within the tolerance everywhere.
[[nodiscard]] std::optional<std::string> gain_fault(const SensorMatrix& matrix, const SensorNames& names,
                                                    double tolerance);

/// A unit that was taken for another, by the factor between the two: "g instead of m/s^2"; empty where none is near.
/// @param doubt  of the factor, as a share of it; at most 0.15 counts
[[nodiscard]] std::string mistaken_unit(double factor, double doubt = 0.0);

}  // namespace veridyn::recording
