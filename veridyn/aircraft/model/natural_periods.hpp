#pragma once

#include <optional>

#include "veridyn/aircraft/model/aero_model.hpp"
#include "veridyn/aircraft/model/subject.hpp"

namespace veridyn::aircraft {

/// Undamped natural periods of the two fast oscillations [s].
struct NaturalPeriods {
  std::optional<double> short_period_s;  ///< of alpha and q; none without CL, Cm or inertia, or where it is unstable
  std::optional<double> dutch_roll_s;    ///< of beta and r; none without CY, Cn or inertia, or where it is unstable
};

/// The periods in straight flight at a point of operation, by the approximations with two states each (Etkin & Reid
/// 1996, Dynamics of Flight, chapter 6): 2 pi over the root of the determinant of
///
///     [Z_alpha, 1 + Z_q; M_alpha, M_q]  and  [Y_beta, -1 + Y_r; N_beta, N_r]
///
/// with derivatives from automatic differentiation of the model. A heavily damped motion has a period here all the
/// same, that of its stiffness. Against the eigenvalues of the whole motion: within 10 % for the short period of
/// `unatrap`; worse where the two are no mode of their own.
/// Parameters without a value (NaN) leave no period.
/// @param at  airspeed [m/s], flow angles and deflections [rad]; normalised rates are those given
/// @param rho  air density [kg/m^3]
[[nodiscard]] NaturalPeriods natural_periods(const Subject& subject, const AeroVariables<double>& at, double rho);

}  // namespace veridyn::aircraft
