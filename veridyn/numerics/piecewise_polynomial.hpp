#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace veridyn::numerics {

/// A function of one variable with its first and second derivative.
template <typename Scalar>
struct FunctionValue {
  Scalar value{};
  Scalar slope{};
  Scalar curvature{};
};

/// A function that is a polynomial between breakpoints: constant, linear, polynomial, piecewise linear, cubic spline
/// (the functions of OpenSim's joints, moving points and couplers), quintic spline through samples in time.
///
/// Below the first and above the last breakpoint the first and the last piece go on; a cubic spline carries a linear
/// piece at each end for OpenSim's straight continuation, a quintic one a constant piece. At a breakpoint the piece
/// that begins there counts. Evaluation neither throws nor allocates; the piece is found by bisection on the value.
class PiecewisePolynomial {
 public:
  /// The zero function.
  PiecewisePolynomial() : origin_{0.0}, coefficient_{0.0} {}

  [[nodiscard]] static PiecewisePolynomial constant(double value);
  /// slope x + intercept
  [[nodiscard]] static PiecewisePolynomial linear(double slope, double intercept);
  /// sum_i coefficient[i] x^i (ascending powers; OpenSim's files list them descending)
  [[nodiscard]] static PiecewisePolynomial polynomial(std::span<const double> ascending);
  /// Straight between the points, the end slopes beyond. x strictly increasing, at least two points.
  [[nodiscard]] static PiecewisePolynomial piecewise_linear(std::span<const double> x, std::span<const double> y);
  /// OpenSim's SimmSpline: the cubic spline of Forsythe, Malcolm & Moler (1977, section 4.4), whose ends take the third
  /// derivative of the cubic through the four end points; straight beyond the ends. Two points make a line, three a
  /// parabola's spline. x strictly increasing, at least two points.
  [[nodiscard]] static PiecewisePolynomial simm_spline(std::span<const double> x, std::span<const double> y);
  /// Natural cubic spline (zero curvature at the ends), straight beyond them. As above.
  [[nodiscard]] static PiecewisePolynomial natural_spline(std::span<const double> x, std::span<const double> y);

  /// The quintic spline through samples (de Boor 2001, chapter XIII): four times continuously differentiable, so that
  /// accelerations of a sampled motion are smooth; the not-a-knot condition at both ends, two knots each. Four or five
  /// points make a cubic, two or three straight lines, one a constant. Beyond the ends the first and the last value
  /// hold. x strictly increasing, at least one point, no NaN.
  [[nodiscard]] static PiecewisePolynomial quintic_spline(std::span<const double> x, std::span<const double> y);
  /// sum_k coefficients[i][k] (x - breaks[i])^k from breaks[i] on, the last piece up to and with `end`; beyond, the
  /// first and the last value hold. `breaks` strictly increasing, at least one, none above `end`; as many coefficients.
  [[nodiscard]] static PiecewisePolynomial held_pieces(std::span<const double> breaks,
                                                       std::span<const std::array<double, 6>> coefficients, double end);

  /// sum_k coefficients[i][k] (x - breaks[i])^k from breaks[i] on, the last piece up to `end`; straight beyond both
  /// ends. Pieces need not meet. `breaks` strictly increasing, at least one, below `end`; as many coefficients.
  [[nodiscard]] static PiecewisePolynomial continued_pieces(std::span<const double> breaks,
                                                            std::span<const std::array<double, 4>> coefficients,
                                                            double end);

  /// Integral from `from` to `to`, exact but for rounding.
  [[nodiscard]] double integral(double from, double to) const;
  /// This function times `factor`.
  [[nodiscard]] PiecewisePolynomial scaled(double factor) const;
  [[nodiscard]] bool is_constant() const { return breaks_.empty() && degree_ == 0; }
  [[nodiscard]] bool is_linear() const { return breaks_.empty() && degree_ <= 1; }

  template <typename Scalar>
  [[nodiscard]] FunctionValue<Scalar> evaluate(const Scalar& x) const {
    const auto piece = static_cast<std::size_t>(std::upper_bound(breaks_.begin(), breaks_.end(), x) - breaks_.begin());
    const Scalar s = x - Scalar(origin_[piece]);
    const std::size_t n = degree_ + 1;
    const double* c = coefficient_.data() + piece * n;
    FunctionValue<Scalar> f{Scalar(c[degree_]), Scalar(0.0), Scalar(0.0)};
    for (std::size_t i = degree_; i-- > 0;) {
      f.curvature = f.curvature * s + f.slope;
      f.slope = f.slope * s + f.value;
      f.value = f.value * s + Scalar(c[i]);
    }
    f.curvature = f.curvature * Scalar(2.0);
    return f;
  }

 private:
  std::vector<double> breaks_;       ///< ascending; pieces = breaks + 1
  std::vector<double> origin_;       ///< one a piece
  std::vector<double> coefficient_;  ///< pieces x (degree + 1), ascending powers of x - origin
  std::size_t degree_ = 0;
};

}  // namespace veridyn::numerics
