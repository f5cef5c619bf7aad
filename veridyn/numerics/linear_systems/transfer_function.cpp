#include "veridyn/numerics/linear_systems/transfer_function.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::numerics {
namespace {

using Complex = std::complex<double>;

template <typename Scalar>
Scalar evaluate(const std::vector<double>& polynomial, Scalar s) {
  Scalar value(0.0);
  for (const double c : polynomial) value = value * s + c;
  return value;
}

std::vector<double> product(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> p(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) p[i + j] += a[i] * b[j];
  return p;
}

std::vector<double> sum(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> s(std::max(a.size(), b.size()), 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) s[s.size() - a.size() + i] += a[i];
  for (std::size_t i = 0; i < b.size(); ++i) s[s.size() - b.size() + i] += b[i];
  return s;
}

void drop_leading_zeros(std::vector<double>& polynomial) {
  const auto first = std::find_if(polynomial.begin(), polynomial.end(), [](double c) { return c != 0.0; });
  polynomial.erase(polynomial.begin(), first);
  if (polynomial.empty()) polynomial.push_back(0.0);
}

/// prod(s - root_i), real.
std::vector<double> polynomial_of(std::span<const Complex> roots, const char* what) {
  std::vector<Complex> p = {1.0};
  for (const Complex root : roots) {
    p.emplace_back(0.0);
    for (std::size_t i = p.size() - 1; i > 0; --i) p[i] -= root * p[i - 1];
  }
  std::vector<double> real;
  double largest = 0.0;
  for (const Complex c : p) largest = std::max(largest, std::abs(c));
  for (const Complex c : p) {
    constexpr double kRounding = 1e-9;
    if (!(std::abs(c.imag()) <= kRounding * largest)) throw InputError(what, "complex ones must be in conjugate pairs");
    real.push_back(c.real());
  }
  return real;
}

double checked(const char* name, double value) {
  if (!(value > 0.0 && std::isfinite(value))) throw InputError(name, fmt::format("is {}; must be > 0", value));
  return value;
}

}  // namespace

Complex TransferFunction::response(double omega) const {
  const Complex s(0.0, omega);
  return evaluate(numerator, s) / evaluate(denominator, s);
}

double TransferFunction::static_gain() const {
  const double top = numerator.back(), bottom = denominator.back();
  return bottom == 0.0 ? kInfinity : top / bottom;
}

void TransferFunction::normalise() {
  const auto finite = [](double c) { return std::isfinite(c); };
  if (!std::ranges::all_of(numerator, finite) || !std::ranges::all_of(denominator, finite))
    throw InputError("transfer function", "has a coefficient that is not finite");
  drop_leading_zeros(numerator);
  drop_leading_zeros(denominator);
  if (denominator.front() == 0.0) throw InputError("transfer function", "has a denominator of zero");
  if (numerator.size() > denominator.size())
    throw InputError("transfer function",
                     fmt::format("has a numerator of degree {} over one of degree {}: it would differentiate its input",
                                 numerator.size() - 1, denominator.size() - 1));
}

TransferFunction operator*(const TransferFunction& a, const TransferFunction& b) {
  return {product(a.numerator, b.numerator), product(a.denominator, b.denominator)};
}

TransferFunction operator*(double gain, TransferFunction a) {
  for (double& c : a.numerator) c *= gain;
  return a;
}

TransferFunction operator+(const TransferFunction& a, const TransferFunction& b) {
  return {sum(product(a.numerator, b.denominator), product(b.numerator, a.denominator)),
          product(a.denominator, b.denominator)};
}

TransferFunction from_zeros_and_poles(std::span<const Complex> zeros, std::span<const Complex> poles, double gain) {
  TransferFunction t = gain * TransferFunction{polynomial_of(zeros, "zeros"), polynomial_of(poles, "poles")};
  t.normalise();
  return t;
}

TransferFunction low_pass(double omega) { return {{checked("omega", omega)}, {1.0, omega}}; }

TransferFunction low_pass(double omega, double zeta) {
  checked("omega", omega);
  return {{omega * omega}, {1.0, 2.0 * checked("zeta", zeta) * omega, omega * omega}};
}

TransferFunction high_pass(double omega) { return {{1.0, 0.0}, {1.0, checked("omega", omega)}}; }

TransferFunction high_pass(double omega, double zeta) {
  checked("omega", omega);
  return {{1.0, 0.0, 0.0}, {1.0, 2.0 * checked("zeta", zeta) * omega, omega * omega}};
}

TransferFunction integrator() { return {{1.0}, {1.0, 0.0}}; }

}  // namespace veridyn::numerics
