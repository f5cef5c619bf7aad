#include "veridyn/numerics/piecewise_polynomial.hpp"

#include <cmath>
#include <cstddef>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::numerics {
namespace {

/// Second derivatives at the knots from a tridiagonal system whose first and last rows are given (Thomas).
std::vector<double> solve_tridiagonal(std::vector<double> diagonal, const std::vector<double>& off,
                                      std::vector<double> right) {
  const std::size_t n = diagonal.size();
  for (std::size_t i = 1; i < n; ++i) {
    const double factor = off[i - 1] / diagonal[i - 1];
    diagonal[i] -= factor * off[i - 1];
    right[i] -= factor * right[i - 1];
  }
  right[n - 1] /= diagonal[n - 1];
  for (std::size_t i = n - 1; i-- > 0;) right[i] = (right[i] - off[i] * right[i + 1]) / diagonal[i];
  return right;
}

struct CubicPieces {
  std::vector<double> breaks;
  std::vector<double> origin;
  std::vector<double> coefficient;
};

/// Pieces from sigma = (second derivative)/6 at the knots, with straight ends.
CubicPieces cubic_pieces(std::span<const double> x, std::span<const double> y, const std::vector<double>& sigma) {
  const std::size_t n = x.size();
  CubicPieces p;
  p.breaks.assign(x.begin(), x.end());
  const auto slope_at_begin = [&](std::size_t i) {
    const double h = x[i + 1] - x[i];
    return (y[i + 1] - y[i]) / h - h * (sigma[i + 1] + 2.0 * sigma[i]);
  };
  const double h_last = x[n - 1] - x[n - 2];
  const double end_slope = (y[n - 1] - y[n - 2]) / h_last + h_last * (sigma[n - 2] + 2.0 * sigma[n - 1]);
  const auto add = [&](double origin, double c0, double c1, double c2, double c3) {
    p.origin.push_back(origin);
    p.coefficient.insert(p.coefficient.end(), {c0, c1, c2, c3});
  };
  add(x[0], y[0], slope_at_begin(0), 0.0, 0.0);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    add(x[i], y[i], slope_at_begin(i), 3.0 * sigma[i], (sigma[i + 1] - sigma[i]) / (x[i + 1] - x[i]));
  }
  add(x[n - 1], y[n - 1], end_slope, 0.0, 0.0);
  return p;
}

/// Of pieces that begin at `breaks`, one before them and one from `end` on.
std::vector<double> origins(std::span<const double> breaks, double end) {
  std::vector<double> all{breaks.front()};
  all.insert(all.end(), breaks.begin(), breaks.end());
  all.push_back(end);
  return all;
}

/// The coefficients of the same.
template <std::size_t N>
std::vector<double> between(const std::array<double, N>& before, std::span<const std::array<double, N>> pieces,
                            const std::array<double, N>& after) {
  std::vector<double> all(before.begin(), before.end());
  for (const std::array<double, N>& c : pieces) all.insert(all.end(), c.begin(), c.end());
  all.insert(all.end(), after.begin(), after.end());
  return all;
}

}  // namespace

PiecewisePolynomial PiecewisePolynomial::constant(double value) {
  PiecewisePolynomial f;
  f.coefficient_ = {value};
  return f;
}

PiecewisePolynomial PiecewisePolynomial::linear(double slope, double intercept) {
  PiecewisePolynomial f;
  f.degree_ = 1;
  f.coefficient_ = {intercept, slope};
  return f;
}

PiecewisePolynomial PiecewisePolynomial::polynomial(std::span<const double> ascending) {
  VERIDYN_ASSERT(!ascending.empty());
  PiecewisePolynomial f;
  f.degree_ = ascending.size() - 1;
  f.coefficient_.assign(ascending.begin(), ascending.end());
  return f;
}

PiecewisePolynomial PiecewisePolynomial::piecewise_linear(std::span<const double> x, std::span<const double> y) {
  VERIDYN_ASSERT(x.size() >= 2 && x.size() == y.size());
  PiecewisePolynomial f;
  f.degree_ = 1;
  f.origin_.clear();
  f.coefficient_.clear();
  f.breaks_.assign(x.begin() + 1, x.end() - 1);
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    f.origin_.push_back(x[i]);
    f.coefficient_.insert(f.coefficient_.end(), {y[i], (y[i + 1] - y[i]) / (x[i + 1] - x[i])});
  }
  return f;
}

PiecewisePolynomial PiecewisePolynomial::simm_spline(std::span<const double> x, std::span<const double> y) {
  VERIDYN_ASSERT(x.size() >= 2 && x.size() == y.size());
  const std::size_t n = x.size();
  if (n == 2) return piecewise_linear(x, y);
  std::vector<double> diagonal(n), off(n - 1), right(n, 0.0);
  std::vector<double> secant(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    off[i] = x[i + 1] - x[i];
    secant[i] = (y[i + 1] - y[i]) / off[i];
  }
  for (std::size_t i = 1; i + 1 < n; ++i) {
    diagonal[i] = 2.0 * (off[i - 1] + off[i]);
    right[i] = secant[i] - secant[i - 1];
  }
  diagonal[0] = -off[0];
  diagonal[n - 1] = -off[n - 2];
  if (n > 3) {
    const auto divided = [&](std::size_t i) {  // second divided difference about knot i
      return (secant[i] - secant[i - 1]) / (x[i + 1] - x[i - 1]);
    };
    right[0] = (divided(2) - divided(1)) * off[0] * off[0] / (x[3] - x[0]);
    right[n - 1] = -(divided(n - 2) - divided(n - 3)) * off[n - 2] * off[n - 2] / (x[n - 1] - x[n - 4]);
  }
  CubicPieces p = cubic_pieces(x, y, solve_tridiagonal(std::move(diagonal), off, std::move(right)));
  PiecewisePolynomial f;
  f.degree_ = 3;
  f.breaks_ = std::move(p.breaks);
  f.origin_ = std::move(p.origin);
  f.coefficient_ = std::move(p.coefficient);
  return f;
}

PiecewisePolynomial PiecewisePolynomial::natural_spline(std::span<const double> x, std::span<const double> y) {
  VERIDYN_ASSERT(x.size() >= 2 && x.size() == y.size());
  const std::size_t n = x.size();
  if (n == 2) return piecewise_linear(x, y);
  std::vector<double> diagonal(n - 2), off(n > 3 ? n - 3 : 0), right(n - 2);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = x[i] - x[i - 1];
    const double after = x[i + 1] - x[i];
    diagonal[i - 1] = 2.0 * (before + after);
    right[i - 1] = (y[i + 1] - y[i]) / after - (y[i] - y[i - 1]) / before;
    if (i + 2 < n) off[i - 1] = after;
  }
  std::vector<double> sigma(n, 0.0);
  const std::vector<double> inner = solve_tridiagonal(std::move(diagonal), off, std::move(right));
  std::copy(inner.begin(), inner.end(), sigma.begin() + 1);
  CubicPieces p = cubic_pieces(x, y, sigma);
  PiecewisePolynomial f;
  f.degree_ = 3;
  f.breaks_ = std::move(p.breaks);
  f.origin_ = std::move(p.origin);
  f.coefficient_ = std::move(p.coefficient);
  return f;
}

PiecewisePolynomial PiecewisePolynomial::held_pieces(std::span<const double> breaks,
                                                     std::span<const std::array<double, 6>> coefficients, double end) {
  VERIDYN_ASSERT(!breaks.empty() && breaks.size() == coefficients.size() && end >= breaks.back());
  const std::array<double, 6>& last = coefficients.back();
  const double s = end - breaks.back();
  double value = last[5];
  for (std::size_t i = 5; i-- > 0;) value = value * s + last[i];
  PiecewisePolynomial f;
  f.degree_ = 5;
  f.origin_ = origins(breaks, end);
  f.coefficient_ = between<6>({coefficients.front()[0]}, coefficients, {value});
  f.breaks_.assign(breaks.begin(), breaks.end());
  // The end itself belongs to the last piece.
  f.breaks_.push_back(std::nextafter(end, kInfinity));
  return f;
}

PiecewisePolynomial PiecewisePolynomial::continued_pieces(std::span<const double> breaks,
                                                          std::span<const std::array<double, 4>> coefficients,
                                                          double end) {
  VERIDYN_ASSERT(!breaks.empty() && breaks.size() == coefficients.size() && end > breaks.back());
  const std::array<double, 4>& c = coefficients.back();
  const double s = end - breaks.back();
  PiecewisePolynomial f;
  f.degree_ = 3;
  f.origin_ = origins(breaks, end);
  f.coefficient_ = between<4>({coefficients.front()[0], coefficients.front()[1]}, coefficients,
                              {((c[3] * s + c[2]) * s + c[1]) * s + c[0], (3.0 * c[3] * s + 2.0 * c[2]) * s + c[1]});
  f.breaks_.assign(breaks.begin(), breaks.end());
  f.breaks_.push_back(end);
  return f;
}

double PiecewisePolynomial::integral(double from, double to) const {
  if (to < from) return -integral(to, from);
  const std::size_t n = degree_ + 1;
  double sum = 0.0;
  for (std::size_t piece = 0; piece < origin_.size(); ++piece) {
    const double a = piece > 0 ? std::max(from, breaks_[piece - 1]) : from;
    const double b = piece < breaks_.size() ? std::min(to, breaks_[piece]) : to;
    if (!(a < b)) continue;
    double at_a = 0.0, at_b = 0.0;
    for (std::size_t i = n; i-- > 0;) {
      const double c = coefficient_[piece * n + i] / static_cast<double>(i + 1);
      at_a = (at_a * (a - origin_[piece])) + c;
      at_b = (at_b * (b - origin_[piece])) + c;
    }
    sum += at_b * (b - origin_[piece]) - at_a * (a - origin_[piece]);
  }
  return sum;
}

PiecewisePolynomial PiecewisePolynomial::scaled(double factor) const {
  PiecewisePolynomial f = *this;
  for (double& c : f.coefficient_) c *= factor;
  return f;
}

}  // namespace veridyn::numerics
