#pragma once

#include <complex>
#include <span>
#include <vector>

namespace veridyn::numerics {

/// Ratio of two polynomials in s, coefficients by descending power: {1, 0} / {2, 1} is s / (2 s + 1).
struct TransferFunction {
  std::vector<double> numerator = {1.0};
  std::vector<double> denominator = {1.0};

  /// At s = j omega. @param omega [rad/s]
  [[nodiscard]] std::complex<double> response(double omega) const;
  /// Coefficients without leading zeros. @throws InputError where one is not finite, the denominator is zero, or the
  /// numerator's degree is larger.
  void normalise();
};

/// In series.
[[nodiscard]] TransferFunction operator*(const TransferFunction& a, const TransferFunction& b);
/// Amplified.
[[nodiscard]] TransferFunction operator*(double gain, TransferFunction a);
/// In parallel.
[[nodiscard]] TransferFunction operator+(const TransferFunction& a, const TransferFunction& b);

/// omega / (s + omega). @param omega break frequency, > 0 [rad/s]
[[nodiscard]] TransferFunction low_pass(double omega);
/// omega^2 / (s^2 + 2 zeta omega s + omega^2). @param zeta damping ratio, > 0
[[nodiscard]] TransferFunction low_pass(double omega, double zeta);
/// s / (s + omega)
[[nodiscard]] TransferFunction high_pass(double omega);
/// s^2 / (s^2 + 2 zeta omega s + omega^2)
[[nodiscard]] TransferFunction high_pass(double omega, double zeta);

}  // namespace veridyn::numerics
