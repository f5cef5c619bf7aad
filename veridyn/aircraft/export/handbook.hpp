#pragma once

#include <optional>
#include <string>
#include <vector>

#include "veridyn/aircraft/model/subject.hpp"

namespace veridyn::aircraft {

/// A number of an aircraft that nobody measured, and the method that it is from.
struct HandbookValue {
  double value = 0.0;
  std::string source;
};

/// Level flight of an aircraft whose lift is known: what its other derivatives are estimated for.
struct HandbookFlight {
  double CL = 0.5;        ///< that carries the weight
  double CL_alpha = 5.0;  ///< lift slope there [1/rad]
  double alpha = 0.0;     ///< angle of attack there [rad]
};

/// Which way the surfaces are counted: +1 where positive is trailing edge down (elevator, right aileron) or left
/// (rudder), -1 the other way round.
struct SurfaceSigns {
  double elevator = 1.0, aileron = 1.0, rudder = 1.0;
};

/// The terms that an aircraft of fixed wings at small angles has, by coefficient: what a coefficient of which nothing
/// is known is made of.
[[nodiscard]] std::vector<Term> handbook_terms(Coefficient coefficient);

/// Estimate of a stability or control derivative from span, wing area and chord, for a straight wing, a tail behind it
/// and low speed. It says of which kind an aircraft of this size is, not which it is: of 104 derivatives of six
/// built-in aircraft 62 % are met within a factor of 2, 79 % within 3, 88 % within 5; Cn_r is the worst (0.05 to 1.7
/// times).
///
/// With the aspect ratio A = b^2/S, tail volumes V_H = 0.5 and V_V = 0.04 (Raymer 2018, table 6.4, homebuilt), tail arm
/// l = 3 c, lift slopes of the tails a_H = 4 and a_V = 3, surfaces of effectiveness 0.5 (ailerons
/// 0.4 from half to 95 % of the span), static margin 0.1, dihedral 3 deg:
///
///     CL_alpha = 2 pi A / (2 + sqrt(4 + A^2))                                 (DATCOM 4.1.3.2, unswept)
///     CD       = 0.0055 * 4.5 + CL^2 / (pi A e), e = 1.78 (1 - 0.045 A^0.68) - 0.64 >= 0.7
///                                                                     (Raymer 2018, table 12.3, eq. 12.48)
///     CL_q = 2 a_H V_H, Cm_q = -CL_q l/c, CL_de = 0.5 a_H V_H c/l, Cm_de = -0.5 a_H V_H
///     Cm_alpha = -0.1 CL_alpha, Cm_0 such that flight at `HandbookFlight::alpha` needs no elevator
///     CY_beta = -a_V V_V b/l, CY_r = 2 a_V V_V, Cn_beta = a_V V_V, Cn_r = -2 a_V V_V l/b,
///     CY_dr = 0.5 a_V V_V b/l, Cn_dr = -0.5 a_V V_V
///     Cl_beta = -CL_alpha 3 deg/4, Cl_p = -CL_alpha/6, Cl_da = -0.4 CL_alpha (0.95^2 - 0.5^2)/4
///     Cl_r = CL/4, Cn_p = -CL/8                              (Nelson 1998, chapters 2 and 3: tails, strips of the
///     wing)
///
/// None for other terms: what no simple method gives is zero.
[[nodiscard]] std::optional<HandbookValue> handbook_value(const Subject& subject, const HandbookFlight& flight,
                                                          const SurfaceSigns& signs, Coefficient coefficient,
                                                          const Term& term);

/// Inertia by radii of gyration, R_x = 0.25, R_y = 0.38, R_z = 0.39 (Raymer 2018, table 16.1, single-engine propeller
/// aircraft): Jx = m b^2 R_x^2/4, Jy = m L^2 R_y^2/4, Jz = m ((b + L)/2)^2 R_z^2/4 with a length L of 0.75 b; Jxz = 0.
[[nodiscard]] Inertia handbook_inertia(const Subject& subject);

}  // namespace veridyn::aircraft
