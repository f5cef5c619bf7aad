// Functions of several arguments of an .osim file.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "veridyn/muscle/osim/osim_function.hpp"

namespace veridyn::muscle::osim {
namespace {

using numerics::MultivariatePolynomial;

int whole_number(const Element& function, const char* property, int least, int most) {
  const double value = function.number_or(property, -1.0);
  if (!function.has(property)) function.fail(property, "missing");
  if (!(value >= least && value <= most) || value != static_cast<int>(value))
    function.fail(property, fmt::format("{} must be a whole number, {} to {}", value, least, most));
  return static_cast<int>(value);
}

MultivariatePolynomial read_polynomial(const Element& function, std::size_t arguments) {
  const int dimension = whole_number(function, "dimension", 1, MultivariatePolynomial::kMostArguments);
  if (static_cast<std::size_t>(dimension) != arguments)
    function.fail("dimension", fmt::format("{} where the function has {} arguments", dimension, arguments));
  const int order = whole_number(function, "order", 0, MultivariatePolynomial::kMostOrder);
  std::vector<double> coefficients = function.numbers("coefficients");
  const std::size_t terms = MultivariatePolynomial::terms(dimension, order);
  if (coefficients.size() != terms)
    function.fail("coefficients", fmt::format("{} numbers; dimension {} and order {} have {} terms",
                                              coefficients.size(), dimension, order, terms));
  return {dimension, order, std::move(coefficients)};
}

MultivariatePolynomial read_several(const Element& function, std::size_t arguments, int depth) {
  constexpr int kDeepest = 8;
  if (depth > kDeepest) function.fail("function", "functions nested too deeply");
  const auto n = static_cast<int>(arguments);
  const std::string type = function.type();
  if (arguments > static_cast<std::size_t>(MultivariatePolynomial::kMostArguments))
    function.fail(
        type, fmt::format("{} arguments; up to {} are understood", arguments, MultivariatePolynomial::kMostArguments));
  if (type == "MultivariatePolynomialFunction") return read_polynomial(function, arguments);
  if (type == "Constant") return {n, 0, {function.number_or("value", 0.0)}};
  if (type == "LinearFunction") {
    std::vector<double> c = function.numbers("coefficients");
    if (c.size() != arguments + 1)
      function.fail("coefficients",
                    fmt::format("{} numbers where {} slopes and the intercept are expected", c.size(), arguments));
    std::reverse(c.begin(), c.end());
    return {n, 1, std::move(c)};
  }
  if (type == "MultiplierFunction") {
    const Element inner = find_function(function, "function");
    if (!inner) function.fail("function", "missing");
    return read_several(inner, arguments, depth + 1).scaled(function.number_or("scale", 1.0));
  }
  function.fail(type, fmt::format("a function of this kind has no {} arguments, or is not understood", arguments));
}

}  // namespace

numerics::MultivariatePolynomial read_function_of_several(const Element& function, std::size_t arguments) {
  return read_several(function, arguments, 0);
}

}  // namespace veridyn::muscle::osim
