#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace veridyn::numerics {

/// A polynomial in several arguments that has all terms up to a total degree, its order.
///
/// Coefficients ascend in powers of the last argument first, then of the one before it: of three arguments (x, y, z)
/// and order 2 they belong to 1, z, z^2, y, yz, y^2, x, xz, xy, x^2. That is the order of OpenSim's
/// `MultivariatePolynomialFunction`.
///
/// Evaluated by Horner's rule in each argument, derivatives with it: a few operations a term. Does not throw or
/// allocate. Check: coefficients 1 to 6, order 2 and (x, y) = (2, 3) give 1 + 2*3 + 3*9 + 4*2 + 5*6 + 6*4 = 96.
class MultivariatePolynomial {
 public:
  static constexpr int kMostArguments = 12;
  static constexpr int kMostOrder = 15;
  using Powers = std::array<unsigned char, kMostArguments>;

  /// Zero, of no argument.
  MultivariatePolynomial() : coefficients_{0.0} {}
  /// As many coefficients as `terms`; 0 <= arguments <= kMostArguments, 0 <= order <= kMostOrder.
  MultivariatePolynomial(int arguments, int order, std::vector<double> coefficients);

  /// (arguments + order)! / (arguments! order!)
  [[nodiscard]] static std::size_t terms(int arguments, int order);
  /// The powers of each argument in every term, in the order of the coefficients.
  [[nodiscard]] static std::vector<Powers> powers(int arguments, int order);

  [[nodiscard]] int arguments() const { return arguments_; }
  [[nodiscard]] int order() const { return order_; }
  [[nodiscard]] const std::vector<double>& coefficients() const { return coefficients_; }
  [[nodiscard]] MultivariatePolynomial scaled(double factor) const;

  template <typename Scalar>
  [[nodiscard]] Scalar value(const Scalar* x) const;
  /// Returns the value; `gradient`, by argument.
  template <typename Scalar>
  Scalar evaluate(const Scalar* x, Scalar* gradient) const;
  /// The same; `hessian` has arguments x arguments entries.
  template <typename Scalar>
  Scalar evaluate(const Scalar* x, Scalar* gradient, Scalar* hessian) const;

 private:
  /// A polynomial of the arguments from `a` on, with derivatives; second ones by one argument are halved.
  template <typename Scalar, int kDerivatives>
  struct Sum {
    Scalar value{};
    std::array<Scalar, kDerivatives >= 1 ? kMostArguments : 1> gradient;
    std::array<Scalar, kDerivatives >= 2 ? kMostArguments * kMostArguments : 1> hessian;
  };
  /// Of total degree `left` from argument `a` on, whose coefficients end at `end`, which goes back to their beginning.
  template <int kDerivatives, typename Scalar>
  void sum(int a, int left, const Scalar* x, const double*& end, Sum<Scalar, kDerivatives>& s) const;
  template <typename Scalar>
  Scalar of_one(const Scalar& x, Scalar* gradient) const;
  template <typename Scalar>
  Scalar of_two(const Scalar& x, const Scalar& y, Scalar* gradient) const;

  int arguments_ = 0;
  int order_ = 0;
  std::vector<double> coefficients_;
};

// Details ------------------------------------------------------------------------------------------------------------

template <int kDerivatives, typename Scalar>
void MultivariatePolynomial::sum(int a, int left, const Scalar* x, const double*& end,
                                 Sum<Scalar, kDerivatives>& s) const {
  constexpr int kRow = kMostArguments;
  const int n = arguments_;
  s.value = Scalar(0.0);
  if constexpr (kDerivatives >= 1)
    for (int k = a; k < n; ++k) s.gradient[k] = Scalar(0.0);
  if constexpr (kDerivatives >= 2)
    for (int k = a; k < n; ++k)
      for (int l = a; l <= k; ++l) s.hessian[k * kRow + l] = Scalar(0.0);
  if (a >= n - 1) {
    for (int i = 0; i <= (a == n - 1 ? left : 0); ++i) {
      if (a == n - 1) {
        if constexpr (kDerivatives >= 2) s.hessian[a * kRow + a] = s.hessian[a * kRow + a] * x[a] + s.gradient[a];
        if constexpr (kDerivatives >= 1) s.gradient[a] = s.gradient[a] * x[a] + s.value;
        s.value = s.value * x[a];
      }
      s.value += Scalar(*--end);
    }
    return;
  }
  Sum<Scalar, kDerivatives> inner;
  for (int power = left; power >= 0; --power) {
    sum(a + 1, left - power, x, end, inner);
    if constexpr (kDerivatives >= 2) {
      for (int k = a + 1; k < n; ++k)
        for (int l = a + 1; l <= k; ++l)
          s.hessian[k * kRow + l] = s.hessian[k * kRow + l] * x[a] + inner.hessian[k * kRow + l];
      for (int k = a; k < n; ++k) s.hessian[k * kRow + a] = s.hessian[k * kRow + a] * x[a] + s.gradient[k];
    }
    if constexpr (kDerivatives >= 1) {
      s.gradient[a] = s.gradient[a] * x[a] + s.value;
      for (int k = a + 1; k < n; ++k) s.gradient[k] = s.gradient[k] * x[a] + inner.gradient[k];
    }
    s.value = s.value * x[a] + inner.value;
  }
}

// The usual cases of fitted paths.

template <typename Scalar>
inline Scalar MultivariatePolynomial::of_one(const Scalar& x, Scalar* gradient) const {
  const double* const c = coefficients_.data();
  Scalar v(c[order_]), d(0.0);
  for (int i = order_ - 1; i >= 0; --i) {
    d = d * x + v;
    v = v * x + Scalar(c[i]);
  }
  gradient[0] = d;
  return v;
}

template <typename Scalar>
inline Scalar MultivariatePolynomial::of_two(const Scalar& x, const Scalar& y, Scalar* gradient) const {
  Scalar value(0.0), by_x(0.0), by_y(0.0);
  const double* row = coefficients_.data() + coefficients_.size();
  for (int j = order_; j >= 0; --j) {
    const int most = order_ - j;
    row -= most + 1;
    Scalar v(row[most]), d(0.0);
    for (int i = most - 1; i >= 0; --i) {
      d = d * y + v;
      v = v * y + Scalar(row[i]);
    }
    by_x = by_x * x + value;
    value = value * x + v;
    by_y = by_y * x + d;
  }
  gradient[0] = by_x;
  gradient[1] = by_y;
  return value;
}

template <typename Scalar>
Scalar MultivariatePolynomial::value(const Scalar* x) const {
  Sum<Scalar, 0> s;
  const double* end = coefficients_.data() + coefficients_.size();
  sum(0, order_, x, end, s);
  return s.value;
}

template <typename Scalar>
inline Scalar MultivariatePolynomial::evaluate(const Scalar* x, Scalar* gradient) const {
  if (arguments_ == 1) return of_one(x[0], gradient);
  if (arguments_ == 2) return of_two(x[0], x[1], gradient);
  Sum<Scalar, 1> s;
  const double* end = coefficients_.data() + coefficients_.size();
  sum(0, order_, x, end, s);
  for (int k = 0; k < arguments_; ++k) gradient[k] = s.gradient[k];
  return s.value;
}

template <typename Scalar>
Scalar MultivariatePolynomial::evaluate(const Scalar* x, Scalar* gradient, Scalar* hessian) const {
  Sum<Scalar, 2> s;
  const double* end = coefficients_.data() + coefficients_.size();
  sum(0, order_, x, end, s);
  for (int k = 0; k < arguments_; ++k) {
    gradient[k] = s.gradient[k];
    for (int l = 0; l < k; ++l)
      hessian[k * arguments_ + l] = hessian[l * arguments_ + k] = s.hessian[k * kMostArguments + l];
    hessian[k * arguments_ + k] = Scalar(2.0) * s.hessian[k * kMostArguments + k];
  }
  return s.value;
}

}  // namespace veridyn::numerics
