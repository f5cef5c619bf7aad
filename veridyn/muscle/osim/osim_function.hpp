#pragma once

#include "veridyn/muscle/osim/osim_element.hpp"
#include "veridyn/numerics/multivariate_polynomial.hpp"
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

/// A function of `arguments` arguments: MultivariatePolynomialFunction, LinearFunction, Constant, and
/// MultiplierFunction of those. @throws InputError naming the element for functions that are not understood or of
/// another number of arguments, and for coefficients that are not as many as terms.
[[nodiscard]] numerics::MultivariatePolynomial read_function_of_several(const Element& function, std::size_t arguments);

}  // namespace veridyn::muscle::osim
