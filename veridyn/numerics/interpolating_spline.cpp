#include "veridyn/numerics/interpolating_spline.hpp"

#include <algorithm>
#include <utility>

#include "veridyn/core/assert.hpp"

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
  const auto begin = knots.begin() + static_cast<std::ptrdiff_t>(p);
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

InterpolatingSpline::InterpolatingSpline(std::span<const double> x, std::span<const double> y) {
  const std::size_t n = x.size();
  VERIDYN_ASSERT(n >= 1 && y.size() == n);
  end_ = x.back();
  if (n == 1) {
    breaks_ = {x.front()};
    coefficients_ = {{y.front()}};
    return;
  }
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
  coefficients_.resize(knots.size() - 2 * p - 1);
  breaks_.assign(knots.begin() + static_cast<std::ptrdiff_t>(p), knots.end() - static_cast<std::ptrdiff_t>(p) - 1);
  double factorial = 1.0;
  for (std::size_t d = 0; d <= p; ++d) {
    if (d > 0) factorial *= static_cast<double>(d);
    // The derivative is a spline of degree p - d whose knots lack d at each end.
    const std::vector<double> inner(knots.begin() + static_cast<std::ptrdiff_t>(d),
                                    knots.end() - static_cast<std::ptrdiff_t>(d));
    for (std::size_t piece = 0; piece < breaks_.size(); ++piece) {
      const std::array<double, 6> b = basis(inner, p - d, piece + p - d, breaks_[piece]);
      double value = 0.0;
      for (std::size_t j = 0; j <= p - d; ++j) value += b[j] * c[d][piece + j];
      coefficients_[piece][d] = value / factorial;
    }
  }
}

InterpolatingSpline InterpolatingSpline::from_pieces(std::vector<double> breaks,
                                                     std::vector<std::array<double, 6>> coefficients, double end) {
  VERIDYN_ASSERT(!breaks.empty() && breaks.size() == coefficients.size() && end >= breaks.back());
  InterpolatingSpline spline;
  spline.breaks_ = std::move(breaks);
  spline.coefficients_ = std::move(coefficients);
  spline.end_ = end;
  return spline;
}

SplineValue InterpolatingSpline::evaluate(double time) const {
  if (time < begin()) return {coefficients_.front()[0], 0.0, 0.0};
  const bool beyond = time > end_;
  const double t = std::min(time, end_);
  const auto piece =
      static_cast<std::size_t>(std::upper_bound(breaks_.begin(), breaks_.end(), t) - breaks_.begin()) - 1;
  const std::array<double, kOrder>& c = coefficients_[piece];
  const double s = t - breaks_[piece];
  SplineValue f{c[kOrder - 1], 0.0, 0.0};
  for (std::size_t i = kOrder - 1; i-- > 0;) {
    f.second = f.second * s + f.first;
    f.first = f.first * s + f.value;
    f.value = f.value * s + c[i];
  }
  f.second *= 2.0;
  if (beyond) return {f.value, 0.0, 0.0};
  return f;
}

}  // namespace veridyn::numerics
