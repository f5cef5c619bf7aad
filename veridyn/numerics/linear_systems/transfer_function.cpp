#include "veridyn/numerics/linear_systems/transfer_function.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

double checked(const char* name, double value) {
  if (!(value > 0.0 && std::isfinite(value))) throw InputError(name, fmt::format("is {}; must be > 0", value));
  return value;
}

}  // namespace

Complex TransferFunction::response(double omega) const {
  const Complex s(0.0, omega);
  return evaluate(numerator, s) / evaluate(denominator, s);
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

}  // namespace veridyn::numerics
