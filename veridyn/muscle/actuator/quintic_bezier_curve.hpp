#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/model/scalar.hpp"
#include "veridyn/numerics/piecewise_polynomial.hpp"

namespace veridyn::muscle {

/// One corner of a muscle curve: control points of x(u) and y(u), 0 <= u <= 1, both of degree 5.
struct QuinticBezierPiece {
  std::array<double, 6> x{};
  std::array<double, 6> y{};
};

/// The corner of Millard et al. (2013): from (x0, y0) with slope d0 to (x1, y1) with slope d1, its second and third
/// point at the fraction 0.1 + 0.8 curviness of the way to the corner where the two tangents meet; curvature is zero at
/// both ends. 0 <= curviness <= 1.
[[nodiscard]] QuinticBezierPiece quintic_corner(double x0, double y0, double d0, double x1, double y1, double d1,
                                                double curviness);

/// A chain of quintic Bezier pieces with straight continuations: the curves of Millard et al. (2013), J. Biomech. Eng.
/// 135:021005. y is a function of x since x(u) of every piece increases; twice continuously differentiable.
///
/// `value` and `value_and_slope` read a table made on construction: each piece is cut in equal cells (as many as it
/// takes) with a polynomial of degree 7 in each. `table_error()` is the greatest difference to the exact curve that was
/// found between the nodes, in the greater of 1 and the value: below 1e-12, with the default curves 3e-14 (the slope
/// follows to 1e-10). Corners too sharp for that (a curviness below 0.1 in the force-velocity curve) are not tabulated;
/// every evaluation then is `exact`, which solves x(u) = x by Newton's method and gives the second derivative as well.
class QuinticBezierCurve {
 public:
  /// The zero function on [0, 1].
  QuinticBezierCurve();
  /// Pieces from left to right, each beginning where the last one ended. @throws InputError when some x(u) does not
  /// increase, which happens with shape parameters that contradict each other.
  QuinticBezierCurve(std::vector<QuinticBezierPiece> pieces, double slope_below, double slope_above);

  /// x as a function of y; the end slopes must not be zero.
  [[nodiscard]] QuinticBezierCurve inverse() const;

  [[nodiscard]] double begin() const { return begin_; }
  [[nodiscard]] double end() const { return end_; }
  [[nodiscard]] double slope_below() const { return slope_below_; }
  [[nodiscard]] double slope_above() const { return slope_above_; }
  [[nodiscard]] double value_at_end() const { return y_end_; }
  [[nodiscard]] double table_error() const { return table_error_; }

  [[nodiscard]] numerics::FunctionValue<double> exact(double x) const;
  /// Integral of y from `begin()` to x, exact to rounding (y(u) x'(u) is a polynomial of degree 9).
  [[nodiscard]] double integral(double x) const;

  [[nodiscard]] CurveValue value_and_slope(double x) const {
    if (x <= begin_) return {y_begin_ + slope_below_ * (x - begin_), slope_below_};
    if (!(x < end_)) return {y_end_ + slope_above_ * (x - end_), slope_above_};
    if (!tabulated_) {
      const numerics::FunctionValue<double> f = exact(x);
      return {f.value, f.slope};
    }
    const Lookup at = look_up(x);
    const double* c = at.coefficient;
    const double t = at.t, t2 = t * t, t4 = t2 * t2;
    const double low = (c[0] + c[1] * t) + t2 * (c[2] + c[3] * t);
    const double high = (c[4] + c[5] * t) + t2 * (c[6] + c[7] * t);
    const double slope_low = (c[1] + 2.0 * c[2] * t) + t2 * (3.0 * c[3] + 4.0 * c[4] * t);
    const double slope_high = (5.0 * c[5] + 6.0 * c[6] * t) + 7.0 * c[7] * t2;
    return {low + t4 * high, (slope_low + t4 * slope_high) * at.cells_per_unit};
  }

  /// With the curvature as well, to about 1e-7: enough to steer an iteration by.
  [[nodiscard]] numerics::FunctionValue<double> tabulated_with_curvature(double x) const {
    if (x <= begin_) return {y_begin_ + slope_below_ * (x - begin_), slope_below_, 0.0};
    if (!(x < end_)) return {y_end_ + slope_above_ * (x - end_), slope_above_, 0.0};
    if (!tabulated_) return exact(x);
    const Lookup at = look_up(x);
    const double* c = at.coefficient;
    const double t = at.t, t2 = t * t, t4 = t2 * t2, per = at.cells_per_unit;
    const double low = (c[0] + c[1] * t) + t2 * (c[2] + c[3] * t);
    const double high = (c[4] + c[5] * t) + t2 * (c[6] + c[7] * t);
    const double slope_low = (c[1] + 2.0 * c[2] * t) + t2 * (3.0 * c[3] + 4.0 * c[4] * t);
    const double slope_high = (5.0 * c[5] + 6.0 * c[6] * t) + 7.0 * c[7] * t2;
    const double bend = (2.0 * c[2] + 6.0 * c[3] * t) + t2 * (12.0 * c[4] + 20.0 * c[5] * t);
    return {low + t4 * high, (slope_low + t4 * slope_high) * per, bend * per * per};
  }

  template <typename Scalar>
  [[nodiscard]] Scalar value(const Scalar& x) const {
    if constexpr (DualNumber<Scalar>) {
      const CurveValue f = value_and_slope(value_of(x));
      return chain(x, f.value, f.slope);
    } else {
      return value_and_slope(x).value;
    }
  }

 private:
  static constexpr std::size_t kMaxPieces = 5;
  static constexpr double kNever = kInfinity;

  /// View of the cell of the table that a value lies in, and where in it.
  struct Lookup {
    const double* coefficient;
    double t;
    double cells_per_unit;
  };
  [[nodiscard]] Lookup look_up(double x) const {
    // Counting is faster than searching: four comparisons without a branch.
    const auto p = static_cast<std::size_t>((x >= break_[0]) + (x >= break_[1]) + (x >= break_[2]) + (x >= break_[3]));
    const double s = (x - piece_begin_[p]) * cells_per_unit_[p];
    const int cell = static_cast<int>(s) < last_cell_[p] ? static_cast<int>(s) : last_cell_[p];
    return {coefficient_.data() + 8 * static_cast<std::size_t>(first_cell_[p] + cell), s - (cell + 0.5),
            cells_per_unit_[p]};
  }
  [[nodiscard]] std::size_t piece_of(double x) const;
  void tabulate();

  std::array<double, kMaxPieces - 1> break_{};
  std::array<double, kMaxPieces> piece_begin_{};
  std::array<double, kMaxPieces> cells_per_unit_{};
  std::array<int, kMaxPieces> first_cell_{};
  std::array<int, kMaxPieces> last_cell_{};  ///< counted from first_cell_
  double begin_ = 0.0, end_ = 1.0, y_begin_ = 0.0, y_end_ = 0.0;
  double slope_below_ = 0.0, slope_above_ = 0.0;
  double table_error_ = 0.0;
  bool tabulated_ = true;
  std::vector<double> coefficient_;  ///< eight a cell, ascending powers of the cell's -1/2 <= t <= 1/2
  std::vector<QuinticBezierPiece> pieces_;
};

}  // namespace veridyn::muscle
