#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/numerics/filters.hpp"
#include "veridyn/vehicle/identification/drive_signals.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

namespace veridyn::vehicle {

/// Relative error of the coefficients that the small angles may make.
inline constexpr double kSmallAngleError = 0.01;

/// Equation error of the bicycle: two linear regressions whose coefficients are functions of C_f, C_r and I_z.
///
/// With k = I_z/m, the forces of the axles follow from the accelerations alone,
///     2 F_f cos(delta) = m (b a_y + k r')/L,      2 F_r = m (a a_y - k r')/L,
/// and with F = C alpha, alpha_f - alpha_r = delta - L r/u (small angles), the lateral velocity drops out:
///
///     delta - L r/u = K a_y + T r' + delta_0,                             K = m/(2L) (b/C_f - a/C_r),
///                                                                         T = I_z/(2L) (1/C_f + 1/C_r)   (1)
///     r u - a_y + b r' = p d/dt(u a_y) - q d/dt(u r') + const [+ c u],    p = m a/(2 L C_r), q = I_z/(2 L C_r)   (2)
///
/// where (2) is d/dt of u alpha_r = -(v - b r) with v' = a_y - r u. K is the understeer gradient. Constants take the
/// biases of steering, accelerometer and gyro; the column u is there when the speed varies by 5 % rms or more. Four
/// coefficients for three unknowns: the consistency equation between them tests the model.
///
/// Where the lateral velocity is measured the direct form is used instead, with alpha from the measurement:
///     a_y = (2 C_f/m) alpha_f cos(delta) + (2 C_r/m) alpha_r + const                                             (1')
///     r'  = (2 a C_f/I_z) alpha_f cos(delta) - (2 b C_r/I_z) alpha_r + const                                     (2')
///
/// A body that leans by phi moves the contact points by h phi': where its roll or roll rate is recorded, and gravity's
/// share of it is not in accel_y (`DriveSignals::gravity_removed`), (2) has a column phi'' with the arm h, (1') and
/// (2') one phi'/u, if they move by more than their noise; in (1) it drops out.
///
/// Every column goes through the same zero-phase filter after it was formed, so a relation between unfiltered signals
/// stays one. W comes from the sensors' noise through the filters, products linearised about the mean speed. The small
/// angles cost about alpha^2/3: 0.4 % at 6 deg; output error has no such error.
struct DriveRegressions {
  bool direct = false;                ///< lateral velocity measured: (1'), (2')
  estimation::RegressionData first;   ///< (1) or (1')
  estimation::RegressionData second;  ///< (2) or (2'), the same rows
  std::vector<double> time;           ///< of rows [s]
  double row_interval_s = 0.0;
  numerics::LowPassDesign filter;
};

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

/// Rows within `spans`, every row whose filters see nothing but that span.
/// @throws InputError when accel_y or steering is missing
[[nodiscard]] DriveRegressions drive_regressions(const DriveSignals& signals, std::span<const TimeSpan> spans,
                                                 const VehicleParameters<double>& known, double pass_Hz);

/// Both regressions by all methods, and the parameters behind them: the point (1/C_f, 1/C_r, I_z) nearest to the four
/// coefficients under their joint covariance, which comes from the scores of both regressions over the same rows with
/// the autocorrelation of their residuals.
[[nodiscard]] DriveRegressionResult equation_error(DriveRegressions data, const VehicleParameters<double>& known,
                                                   const estimation::RegressionOptions& options);

}  // namespace veridyn::vehicle
