#pragma once

#include <Eigen/Core>
#include <span>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/vehicle/identification/fit/vehicle_estimate.hpp"
#include "veridyn/vehicle/identification/fit/vehicle_problem.hpp"
#include "veridyn/vehicle/identification/validation/drive_validation.hpp"

namespace veridyn::vehicle {

/// All DriveUnknowns of a vehicle on a drive whose constant biases (steering, yaw rate, accel_y) are fitted to it, for
/// predictions: biases belong to the day, not to the vehicle.
[[nodiscard]] Eigen::VectorXd fit_drive_biases(const DriveSignals& signals, std::span<const TimeSpan> spans,
                                               const VehicleParameters<double>& vehicle,
                                               const DriveModelOptions& options, Progress& progress);

/// As the chosen estimate has them; constant biases that it does not know are fitted. `output_error` may be null where
/// the estimate is of another method.
[[nodiscard]] DriveTheta theta_of(const VehicleProblem& problem, const VehicleEstimate& estimate,
                                  const estimation::OutputErrorEstimate* output_error, Progress& progress);

/// What noise of steering and speed does to a prediction over the identification segments: that much noise once more,
/// and the difference to `fit` as its quantities' fits.
[[nodiscard]] DriveValidation with_noisier_inputs(const VehicleProblem& problem, const DriveTheta& theta,
                                                  const DriveValidation& fit, Progress& progress);

}  // namespace veridyn::vehicle
