#include "veridyn/muscle/actuator/quintic_bezier_curve.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::muscle {
namespace {

struct Quintic {
  double value, first, second;
};

// De Casteljau's differences in Bernstein form.
Quintic quintic(const std::array<double, 6>& p, double u) {
  const double w = 1.0 - u;
  std::array<double, 5> d{};
  for (std::size_t i = 0; i < 5; ++i) d[i] = 5.0 * (p[i + 1] - p[i]);
  std::array<double, 4> e{};
  for (std::size_t i = 0; i < 4; ++i) e[i] = 4.0 * (d[i + 1] - d[i]);
  const double u2 = u * u, w2 = w * w;
  return {w2 * w2 * (w * p[0] + 5.0 * u * p[1]) + 10.0 * u2 * w2 * (w * p[2] + u * p[3]) +
              u2 * u2 * (5.0 * w * p[4] + u * p[5]),
          w2 * w2 * d[0] + 4.0 * u * w * (w2 * d[1] + u2 * d[3]) + 6.0 * u2 * w2 * d[2] + u2 * u2 * d[4],
          w2 * w * e[0] + 3.0 * u * w * (w * e[1] + u * e[2]) + u2 * u * e[3]};
}

// x(u) = x, u in [0, 1]: Newton's method within a shrinking bracket.
double parameter_at(const QuinticBezierPiece& piece, double x, double start) {
  double low = 0.0, high = 1.0, u = start;
  for (int i = 0; i < 200; ++i) {
    const Quintic at = quintic(piece.x, u);
    (at.value < x ? low : high) = u;
    const double next = u - (at.value - x) / at.first;
    // Newton's error is of the order of the square of its step.
    if (std::abs(next - u) < 1e-9) return std::clamp(next, 0.0, 1.0);
    u = next > low && next < high ? next : 0.5 * (low + high);
  }
  return u;
}

double parameter_at(const QuinticBezierPiece& piece, double x) {
  return parameter_at(piece, x, std::clamp((x - piece.x[0]) / (piece.x[5] - piece.x[0]), 0.0, 1.0));
}

bool increases(const std::array<double, 6>& x) {
  if (!(x[5] > x[0])) return false;
  for (int i = 0; i <= 200; ++i)
    if (!(quintic(x, i / 200.0).first > 1e-9 * (x[5] - x[0]))) return false;
  return true;
}

constexpr int kPolynomialDegree = 7;
using Cell = Eigen::Matrix<double, kPolynomialDegree + 1, 1>;

}  // namespace

QuinticBezierPiece quintic_corner(double x0, double y0, double d0, double x1, double y1, double d1, double curviness) {
  constexpr double kParallel = 1.4901161193847656e-8;  // square root of the machine's epsilon, as OpenSim takes it
  const double k = 0.1 + 0.8 * curviness;
  const double corner_x = std::abs(d0 - d1) > kParallel ? (y1 - y0 - x1 * d1 + x0 * d0) / (d0 - d1) : 0.5 * (x0 + x1);
  const double corner_y = (corner_x - x1) * d1 + y1;
  const double xa = x0 + k * (corner_x - x0), ya = y0 + k * (corner_y - y0);
  const double xb = x1 + k * (corner_x - x1), yb = y1 + k * (corner_y - y1);
  return {{x0, xa, xa, xb, xb, x1}, {y0, ya, ya, yb, yb, y1}};
}

QuinticBezierCurve::QuinticBezierCurve() : QuinticBezierCurve({quintic_corner(0, 0, 0, 1, 0, 0, 0.5)}, 0.0, 0.0) {}

QuinticBezierCurve::QuinticBezierCurve(std::vector<QuinticBezierPiece> pieces, double slope_below, double slope_above)
    : slope_below_(slope_below), slope_above_(slope_above), pieces_(std::move(pieces)) {
  VERIDYN_ASSERT(!pieces_.empty() && pieces_.size() <= kMaxPieces);
  for (const QuinticBezierPiece& piece : pieces_)
    if (!increases(piece.x))
      throw InputError("muscle curve",
                       fmt::format("its corner from x = {:.6g} to x = {:.6g} is no function: the shape parameters "
                                   "contradict each other",
                                   piece.x[0], piece.x[5]));
  begin_ = pieces_.front().x[0];
  y_begin_ = pieces_.front().y[0];
  end_ = pieces_.back().x[5];
  y_end_ = pieces_.back().y[5];
  tabulate();
}

QuinticBezierCurve QuinticBezierCurve::inverse() const {
  VERIDYN_ASSERT(slope_below_ != 0.0 && slope_above_ != 0.0);
  std::vector<QuinticBezierPiece> swapped;
  for (const QuinticBezierPiece& piece : pieces_) swapped.push_back({piece.y, piece.x});
  return {std::move(swapped), 1.0 / slope_below_, 1.0 / slope_above_};
}

std::size_t QuinticBezierCurve::piece_of(double x) const {
  return static_cast<std::size_t>((x >= break_[0]) + (x >= break_[1]) + (x >= break_[2]) + (x >= break_[3]));
}

numerics::FunctionValue<double> QuinticBezierCurve::exact(double x) const {
  if (x <= begin_) return {y_begin_ + slope_below_ * (x - begin_), slope_below_, 0.0};
  if (!(x < end_)) return {y_end_ + slope_above_ * (x - end_), slope_above_, 0.0};
  const QuinticBezierPiece& piece = pieces_[piece_of(x)];
  const double u = parameter_at(piece, x);
  const Quintic qx = quintic(piece.x, u), qy = quintic(piece.y, u);
  const double slope = qy.first / qx.first;
  return {qy.value, slope, (qy.second - slope * qx.second) / (qx.first * qx.first)};
}

double QuinticBezierCurve::integral(double x) const {
  if (x <= begin_) return (x - begin_) * (y_begin_ + 0.5 * slope_below_ * (x - begin_));
  double sum = 0.0;
  // Gauss-Legendre with five points is exact to degree 9.
  constexpr std::array<double, 5> kNode{-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831,
                                        0.9061798459386640};
  constexpr std::array<double, 5> kWeight{0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                          0.4786286704993665, 0.2369268850561891};
  for (const QuinticBezierPiece& piece : pieces_) {
    if (x <= piece.x[0]) return sum;
    const double to = x < piece.x[5] ? parameter_at(piece, x) : 1.0;
    for (std::size_t i = 0; i < 5; ++i) {
      const double u = 0.5 * to * (1.0 + kNode[i]);
      sum += 0.5 * to * kWeight[i] * quintic(piece.y, u).value * quintic(piece.x, u).first;
    }
  }
  if (x > end_) sum += (x - end_) * (y_end_ + 0.5 * slope_above_ * (x - end_));
  return sum;
}

void QuinticBezierCurve::tabulate() {
  break_.fill(kNever);
  piece_begin_.fill(begin_);
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    if (p > 0) break_[p - 1] = pieces_[p].x[0];
    piece_begin_[p] = pieces_[p].x[0];
  }

  // Interpolation at Chebyshev's points of [-1/2, 1/2]; the error is looked at halfway between them.
  Cell node, between;
  Eigen::Matrix<double, kPolynomialDegree + 1, kPolynomialDegree + 1> powers;
  for (int i = 0; i <= kPolynomialDegree; ++i) {
    node(i) = -0.5 * std::cos(kPi * (i + 0.5) / (kPolynomialDegree + 1));
    between(i) = -0.5 * std::cos(kPi * i / kPolynomialDegree);
    for (int j = 0; j <= kPolynomialDegree; ++j) powers(i, j) = std::pow(node(i), j);
  }
  const auto solve = powers.partialPivLu();

  constexpr double kGoal = 3e-14, kLimit = 1e-12;
  constexpr int kMaxCells = 1024;
  table_error_ = 0.0;
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    const QuinticBezierPiece& piece = pieces_[p];
    const double width = piece.x[5] - piece.x[0];
    std::vector<double> best;
    double best_error = kNever, last_error = kNever;
    for (int cells = 16; cells <= kMaxCells && best_error > kGoal; cells *= 2) {
      std::vector<double> table(static_cast<std::size_t>(8 * cells));
      double error = 0.0, u = 0.0;
      for (int cell = 0; cell < cells; ++cell) {
        Cell y;
        const auto x_at = [&](double t) { return piece.x[0] + width * (cell + 0.5 + t) / cells; };
        for (int i = 0; i <= kPolynomialDegree; ++i) {
          u = parameter_at(piece, x_at(node(i)), u);
          y(i) = quintic(piece.y, u).value;
        }
        const Cell c = solve.solve(y);
        std::copy(c.data(), c.data() + 8, table.begin() + 8 * cell);
        for (int i = 0; i <= kPolynomialDegree; ++i) {
          const double t = between(i);
          u = parameter_at(piece, std::min(x_at(t), piece.x[5]), u);
          const Quintic qx = quintic(piece.x, u), qy = quintic(piece.y, u);
          double value = 0.0, slope = 0.0;
          for (int j = kPolynomialDegree; j >= 0; --j) {
            slope = slope * t + value;
            value = value * t + c(j);
          }
          const double scale = std::max(1.0, std::abs(qy.value));
          // Ten times laxer on the slope in units of the value per cell: it follows from the values.
          error = std::max({error, std::abs(value - qy.value) / scale,
                            0.1 * std::abs(slope - qy.first / qx.first * width / cells) / scale});
        }
        u = std::min(u, 1.0);
      }
      // Rounding is reached when smaller cells no longer help.
      const bool rounding = error < kLimit && error > 0.1 * last_error;
      last_error = error;
      if (error < best_error) {
        best_error = error;
        best = std::move(table);
      }
      if (rounding) break;
    }
    if (!(best_error < kLimit)) {
      tabulated_ = false;
      table_error_ = 0.0;
      return;
    }
    const auto cells = static_cast<int>(best.size() / 8);
    first_cell_[p] = static_cast<int>(coefficient_.size() / 8);
    last_cell_[p] = cells - 1;
    cells_per_unit_[p] = cells / width;
    coefficient_.insert(coefficient_.end(), best.begin(), best.end());
    table_error_ = std::max(table_error_, best_error);
  }
}

}  // namespace veridyn::muscle
