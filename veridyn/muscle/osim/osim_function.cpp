#include "veridyn/muscle/osim/osim_function.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace veridyn::muscle::osim {
namespace {

constexpr std::array<std::string_view, 10> kFunctions{
    "Constant",  "LinearFunction",          "SimmSpline",         "NaturalCubicSpline", "natCubicSpline",
    "GCVSpline", "PiecewiseLinearFunction", "PolynomialFunction", "MultiplierFunction", "PiecewiseConstantFunction"};

bool is_function(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  return std::find(kFunctions.begin(), kFunctions.end(), name) != kFunctions.end() ||
         name.find("Function") != std::string_view::npos || name.find("Spline") != std::string_view::npos;
}

struct Points {
  std::vector<double> x;
  std::vector<double> y;
};

Points read_points(const Element& function) {
  Points points{function.numbers("x"), function.numbers("y")};
  if (points.x.size() != points.y.size()) {
    function.fail("x, y", fmt::format("{} and {} numbers, as many are expected", points.x.size(), points.y.size()));
  }
  if (points.x.size() < 2) function.fail("x", "a spline takes at least two points");
  for (std::size_t i = 1; i < points.x.size(); ++i) {
    if (!(points.x[i] > points.x[i - 1])) {
      function.fail("x", fmt::format("{} after {} does not ascend", points.x[i], points.x[i - 1]));
    }
  }
  return points;
}

numerics::PiecewisePolynomial read_function(const Element& function, int depth) {
  constexpr int kDeepest = 8;
  if (depth > kDeepest) function.fail("function", "functions nested too deeply");
  const std::string type = function.type();
  if (type == "Constant") return numerics::PiecewisePolynomial::constant(function.number_or("value", 0.0));
  if (type == "LinearFunction") {
    const std::vector<double> c = function.numbers("coefficients");
    if (c.empty()) return numerics::PiecewisePolynomial::linear(1.0, 0.0);
    if (c.size() != 2)
      function.fail("coefficients", fmt::format("{} numbers where slope and intercept are expected", c.size()));
    return numerics::PiecewisePolynomial::linear(c[0], c[1]);
  }
  if (type == "PolynomialFunction") {
    std::vector<double> c = function.numbers("coefficients");
    if (c.empty()) function.fail("coefficients", "missing");
    std::reverse(c.begin(), c.end());
    return numerics::PiecewisePolynomial::polynomial(c);
  }
  if (type == "SimmSpline" || type == "NaturalCubicSpline" || type == "natCubicSpline") {
    const Points points = read_points(function);
    return numerics::PiecewisePolynomial::simm_spline(points.x, points.y);
  }
  if (type == "PiecewiseLinearFunction") {
    const Points points = read_points(function);
    return numerics::PiecewisePolynomial::piecewise_linear(points.x, points.y);
  }
  if (type == "GCVSpline") {
    if (function.number_or("half_order", 2.0) != 2.0 || function.number_or("error_variance", 0.0) != 0.0) {
      function.fail("GCVSpline",
                    "only cubic splines through their points (half_order 2, error_variance 0) are understood");
    }
    const Points points = read_points(function);
    return numerics::PiecewisePolynomial::natural_spline(points.x, points.y);
  }
  if (type == "MultivariatePolynomialFunction") {
    // Of one argument, ascending.
    return numerics::PiecewisePolynomial::polynomial(read_function_of_several(function, 1).coefficients());
  }
  if (type == "MultiplierFunction") {
    const Element inner = find_function(function, "function");
    if (!inner) function.fail("function", "missing");
    return read_function(inner, depth + 1).scaled(function.number_or("scale", 1.0));
  }
  function.fail(type, "a function of this kind is not understood");
}

}  // namespace

Element find_function(const Element& owner, const char* property) {
  for (const pugi::xml_node node : {owner.node(), owner.document().defaults(owner.node().name())}) {
    for (const pugi::xml_node child : node.children()) {
      if (std::strcmp(child.attribute("name").value(), property) == 0 && is_function(child))
        return {owner.document(), child};
    }
  }
  for (const pugi::xml_node child : owner.property(property).children()) {
    if (child.type() == pugi::node_element) return {owner.document(), child};
  }
  return {owner.document(), {}};
}

numerics::PiecewisePolynomial read_function(const Element& function) { return read_function(function, 0); }

}  // namespace veridyn::muscle::osim
