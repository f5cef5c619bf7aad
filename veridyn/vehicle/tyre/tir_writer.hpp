#pragma once

#include <string>
#include <vector>

#include "veridyn/vehicle/tyre/simple_magic_formula.hpp"

namespace veridyn::vehicle {

/// What a tyre file says besides its coefficients.
struct TirNotes {
  std::vector<std::string> comments = {};  ///< one line each, at the head
  double radius = 0.3;                     ///< unloaded [m]
  double vertical_stiffness = 0.0;         ///< [N/m]; 0: not given
};

/// A tyre property file (PAC2002, TeimOrbit format, SI and radians) of a reduced Magic Formula tyre, for `read_tir` and
/// other programs. The formulas contain the reduced ones: stiffness over load is exact where it depends on the load at
/// all, else to 1e-6; friction over load to first order about the nominal load. Pure slip; without R coefficients.
[[nodiscard]] std::string write_tir(const SimpleMagicFormulaTyre<double>& tyre, const TirNotes& notes);

}  // namespace veridyn::vehicle
