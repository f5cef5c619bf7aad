#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/result/analysis.hpp"
#include "veridyn/vehicle/identification/fit/drive_parametric_model.hpp"
#include "veridyn/vehicle/identification/signals/drive_signals.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

namespace veridyn::vehicle {

/// Measured and predicted motion over one span.
struct PredictedStretch {
  TimeSpan span;
  std::vector<double> time;
  std::vector<double> steer, speed;
  std::vector<double> yaw_rate, yaw_rate_predicted, yaw_rate_sigma;  ///< sigma: of the prediction, by the parameters
  std::vector<double> accel_y, accel_y_predicted, accel_y_sigma;     ///< at the sensor; empty without
  std::vector<double> lateral_velocity, lateral_velocity_predicted;  ///< the former empty where not measured
  std::vector<double> yaw, yaw_predicted;                            ///< heading from the span's beginning [rad]
  /// Path from the span's beginning, heading 0 there: measured position (where recorded, turned by the heading with
  /// which it fits best) and prediction.
  std::vector<double> x, y, x_predicted, y_predicted;
};

/// A drive as a model predicts it.
struct DriveValidation {
  /// "yaw_rate", "accel_y", "lateral_velocity", "yaw", "path", each over all spans.
  std::vector<estimation::PredictedQuantity> quantities;
  /// "roll" and "roll_rate" of a body that rolls, where they are recorded.
  std::vector<estimation::PredictedQuantity> roll_quantities;
  std::vector<PredictedStretch> stretches;
  std::string text;  ///< one sentence
  /// Null where the quantity was not compared.
  [[nodiscard]] const estimation::PredictedQuantity* find(std::string_view name) const;
};

/// Values of all DriveUnknowns, in their order, and their covariance.
struct DriveTheta {
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance = {};  ///< empty: not known
};

/// Simulates a vehicle over spans and compares. Per span two numbers are fitted, v and r at its beginning (the sideslip
/// is not measured on most cars); all else is given. Measured yaw angle is the integral of the measured yaw rate less
/// its bias. The covariance of theta gives the bands of the prediction. An interrupted `progress` leaves out the spans
/// that are not yet predicted.
[[nodiscard]] DriveValidation predict_drive(const DriveSignals& signals, std::span<const TimeSpan> spans,
                                            const VehicleParameters<double>& vehicle, const DriveModelOptions& options,
                                            const DriveTheta& theta, Progress& progress);

}  // namespace veridyn::vehicle
