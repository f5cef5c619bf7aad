#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/vehicle/identification/fit/drive_regression.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

namespace veridyn::vehicle {

/// Relative error of the coefficients that the small angles may make.
inline constexpr double kSmallAngleError = 0.01;

/// The physical parameters that one regression method gives.
struct AxleEstimate {
  estimation::Method method = estimation::Method::kOls;
  bool usable = false;
  std::string message;
  Eigen::Vector3d value = Eigen::Vector3d::Zero();       ///< C_f, C_r [N/rad], I_z [kg m^2]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< mass, a, b taken as exact
  double understeer = 0.0;                               ///< [rad/(m/s^2)]
  double understeer_sigma = 0.0;
  bool understeer_only = false;  ///< steady cornering: K is determined, C_f and C_r are not
  double steer_bias = 0.0;       ///< delta_0 of (1) [rad]; what steering, gyro and accelerometer biases amount to
  double steer_bias_sigma = 0.0;
  double consistency_p = 1.0;  ///< of "the four coefficients belong to one bicycle" (chi-square, 1 degree of freedom)
  double degrees_of_freedom = 0.0;
};

/// Equation error by all methods.
struct DriveRegressionResult {
  DriveRegressions data;
  estimation::RegressionComparison first, second;
  std::vector<AxleEstimate> axles;  ///< one per method
  estimation::Method recommended = estimation::Method::kGtls;
  bool recommends = false;  ///< both regressions' comparisons recommend a method
  std::string reason;       ///< why, or why there is nothing to recommend
  /// Null where the method gave no estimate.
  [[nodiscard]] const AxleEstimate* find(estimation::Method method) const;
};

/// Both regressions by all methods, and the parameters behind them: the point (1/C_f, 1/C_r, I_z) nearest to the four
/// coefficients under their joint covariance, which comes from the scores of both regressions over the same rows with
/// the autocorrelation of their residuals.
[[nodiscard]] DriveRegressionResult equation_error(DriveRegressions data, const VehicleParameters<double>& known,
                                                   const estimation::RegressionOptions& options);

}  // namespace veridyn::vehicle
