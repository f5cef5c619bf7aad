#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "veridyn/estimation/result/estimate.hpp"
#include "veridyn/vehicle/identification/options/drive_model_options.hpp"

namespace veridyn::vehicle {

/// The drive model that an estimate describes.
struct EstimatedDriveModel {
  VehicleParameters<double> vehicle;
  DriveModelOptions options;              ///< structure, tyre and starts are the estimate's
  Eigen::MatrixXd covariance;             ///< of all DriveUnknowns, as far as the estimate has it; else 0
  std::vector<std::string> missing = {};  ///< of C_f, C_r and I_z those that it does not have
};

/// `vehicle` and `options` with the values of an estimate, as `identify` writes it; the wheelbase stays. Biases are
/// each drive's own and stay as `options` has them.
[[nodiscard]] EstimatedDriveModel estimated_drive_model(const estimation::Estimate& estimate,
                                                        const VehicleParameters<double>& vehicle,
                                                        const DriveModelOptions& options);

}  // namespace veridyn::vehicle
