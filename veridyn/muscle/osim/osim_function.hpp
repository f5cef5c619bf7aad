#pragma once

#include "veridyn/muscle/osim/osim_element.hpp"
#include "veridyn/numerics/piecewise_polynomial.hpp"

namespace veridyn::muscle::osim {

/// The function object within `owner`'s property `property`: the object itself carries that name as its attribute
/// (OpenSim 4) or stands within an element of that name (before). Constant, LinearFunction, SimmSpline,
/// NaturalCubicSpline, PiecewiseLinearFunction, PolynomialFunction, GCVSpline of degree 3 without smoothing, and
/// MultiplierFunction of those. Empty when there is none.
[[nodiscard]] Element find_function(const Element& owner, const char* property);

/// @throws InputError naming the element for functions that are not understood, have too few or unordered points or
/// numbers that are not finite.
[[nodiscard]] numerics::PiecewisePolynomial read_function(const Element& function);

}  // namespace veridyn::muscle::osim
