#pragma once

#include <span>
#include <vector>

#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/numerics/filters.hpp"
#include "veridyn/vehicle/identification/signals/drive_signals.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

namespace veridyn::vehicle {

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

/// Rows within `spans`, every row whose filters see nothing but that span.
/// @throws InputError when accel_y or steering is missing
[[nodiscard]] DriveRegressions drive_regressions(const DriveSignals& signals, std::span<const TimeSpan> spans,
                                                 const VehicleParameters<double>& known, double pass_Hz);

}  // namespace veridyn::vehicle
