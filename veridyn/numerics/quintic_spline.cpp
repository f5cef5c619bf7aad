// The quintic spline through samples.
#include <algorithm>
#include <array>
#include <utility>

#include "veridyn/core/assert.hpp"
#include "veridyn/numerics/piecewise_polynomial.hpp"

namespace veridyn::numerics {
namespace {

/// Knots of the not-a-knot interpolant of odd degree p: the data points but the (p - 1)/2 next to each end.
std::vector<double> knots_of(std::span<const double> x, std::size_t p) {
  std::vector<double> knots(p + 1, x.front());
  const std::size_t skip = (p + 1) / 2;
  for (std::size_t i = skip; i + skip < x.size(); ++i) knots.push_back(x[i]);
  knots.insert(knots.end(), p + 1, x.back());
  return knots;
}

/// Index i with knots[i] <= x < knots[i + 1], the last one at the right end.
std::size_t knot_span(const std::vector<double>& knots, std::size_t p, double x) {
  const auto begin = knots.begin() + p;
  const auto end = knots.end() - static_cast<std::ptrdiff_t>(p) - 1;
  const auto after = std::upper_bound(begin, end, x);
  return static_cast<std::size_t>(std::max(after - knots.begin(), begin - knots.begin() + 1)) - 1;
}

/// The p + 1 basis functions that do not vanish on `span` (Cox and de Boor).
std::array<double, 6> basis(const std::vector<double>& knots, std::size_t p, std::size_t span, double x) {
  std::array<double, 6> value{1.0};
  for (std::size_t d = 1; d <= p; ++d) {
    double carried = 0.0;
    for (std::size_t r = 0; r < d; ++r) {
      const double right = knots[span + r + 1], left = knots[span + 1 + r - d];
      const double term = value[r] / (right - left);
      value[r] = carried + (right - x) * term;
      carried = (x - left) * term;
    }
    value[d] = carried;
  }
  return value;
}

/// Solves the banded collocation equations in place; totally positive, so that elimination needs no pivots.
std::vector<double> solve_banded(std::vector<std::array<double, 11>>& rows, std::vector<double> right) {
  constexpr std::size_t kHalf = 5;
  const std::size_t n = rows.size();
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = k + 1; i < std::min(n, k + kHalf + 1); ++i) {
      const double factor = rows[i][kHalf + k - i] / rows[k][kHalf];
      if (factor == 0.0) continue;
      for (std::size_t j = k; j < std::min(n, k + kHalf + 1); ++j)
        rows[i][kHalf + j - i] -= factor * rows[k][kHalf + j - k];
      right[i] -= factor * right[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < std::min(n, k + kHalf + 1); ++j) right[k] -= rows[k][kHalf + j - k] * right[j];
    right[k] /= rows[k][kHalf];
  }
  return right;
}

}  // namespace

PiecewisePolynomial PiecewisePolynomial::quintic_spline(std::span<const double> x, std::span<const double> y) {
  const std::size_t n = x.size();
  VERIDYN_ASSERT(n >= 1 && y.size() == n);
  if (n == 1) return held_pieces(x, std::vector<std::array<double, 6>>{{y.front()}}, x.back());
  const std::size_t p = n >= 6 ? 5 : (n >= 4 ? 3 : 1);
  const std::vector<double> knots = knots_of(x, p);
  std::vector<std::array<double, 11>> rows(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t span = knot_span(knots, p, x[i]);
    const std::array<double, 6> b = basis(knots, p, span, x[i]);
    for (std::size_t j = 0; j <= p; ++j) rows[i][5 + span - p + j - i] = b[j];
  }
  // Coefficients of the spline and of its derivatives.
  std::vector<std::vector<double>> c{solve_banded(rows, std::vector<double>(y.begin(), y.end()))};
  for (std::size_t d = 1; d <= p; ++d) {
    std::vector<double> next(n - d);
    for (std::size_t i = 0; i + d < n; ++i) {
      const double width = knots[i + p + 1] - knots[i + d];
      next[i] = width > 0.0 ? static_cast<double>(p - d + 1) * (c.back()[i + 1] - c.back()[i]) / width : 0.0;
    }
    c.push_back(std::move(next));
  }
  std::vector<std::array<double, 6>> coefficients(knots.size() - 2 * p - 1);
  const std::vector<double> breaks(knots.begin() + p, knots.end() - static_cast<std::ptrdiff_t>(p) - 1);
  double factorial = 1.0;
  for (std::size_t d = 0; d <= p; ++d) {
    if (d > 0) factorial *= static_cast<double>(d);
    // The derivative is a spline of degree p - d whose knots lack d at each end.
    const std::vector<double> inner(knots.begin() + d, knots.end() - d);
    for (std::size_t piece = 0; piece < breaks.size(); ++piece) {
      const std::array<double, 6> b = basis(inner, p - d, piece + p - d, breaks[piece]);
      double value = 0.0;
      for (std::size_t j = 0; j <= p - d; ++j) value += b[j] * c[d][piece + j];
      coefficients[piece][d] = value / factorial;
    }
  }
  return held_pieces(breaks, coefficients, x.back());
}

}  // namespace veridyn::numerics
