#include "veridyn/vehicle/manoeuvre/path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/piecewise_polynomial.hpp"

namespace veridyn::vehicle {
namespace {

/// Sub-intervals of a polynomial piece, each integrated by five Gauss points.
constexpr std::size_t kParts = 32;

struct Derivatives {
  double value = 0.0, first = 0.0, second = 0.0;
};

Derivatives evaluate(const std::array<double, 6>& c, double p) {
  Derivatives d;
  for (std::size_t k = c.size(); k-- > 0;) {
    d.second = d.second * p + 2.0 * d.first;
    d.first = d.first * p + d.value;
    d.value = d.value * p + c[k];
  }
  return d;
}

double speed(const Path::Polynomial& c, double p) { return std::hypot(evaluate(c.x, p).first, evaluate(c.y, p).first); }

/// Arc length from p0 to p1 (Gauss-Legendre, Abramowitz & Stegun 25.4.29).
double arc_length(const Path::Polynomial& c, double p0, double p1) {
  static constexpr std::array<double, 3> kNode{0.0, 0.538469310105683, 0.906179845938664};
  static constexpr std::array<double, 3> kWeight{0.568888888888889, 0.478628670499366, 0.236926885056189};
  const double middle = 0.5 * (p0 + p1), half = 0.5 * (p1 - p0);
  double sum = kWeight[0] * speed(c, middle);
  for (std::size_t i = 1; i < 3; ++i) {
    sum += kWeight[i] * (speed(c, middle + half * kNode[i]) + speed(c, middle - half * kNode[i]));
  }
  return half * sum;
}

double nearest_turn(double angle, double reference) {
  return angle + 2.0 * kPi * std::round((reference - angle) / (2.0 * kPi));
}

/// The polynomial on [0, 1] with these values and derivatives at its ends (in p).
std::array<double, 6> hermite(const Derivatives& begin, const Derivatives& end) {
  const double c0 = begin.value, c1 = begin.first, c2 = 0.5 * begin.second;
  const double e0 = end.value - c0 - c1 - c2;
  const double e1 = end.first - c1 - 2.0 * c2;
  const double e2 = end.second - 2.0 * c2;
  return {c0, c1, c2, 10.0 * e0 - 4.0 * e1 + 0.5 * e2, -15.0 * e0 + 7.0 * e1 - e2, 6.0 * e0 - 3.0 * e1 + 0.5 * e2};
}

}  // namespace

Path::Path(double x, double y, double heading) : start_{x, y, heading, 0.0}, end_(start_) {}

Path& Path::append_arc(double length, double curvature) {
  VERIDYN_ASSERT(length > 0.0 && std::isfinite(curvature));
  Piece piece;
  piece.begin = length_;
  piece.length = length;
  piece.start = {end_.x, end_.y, end_.heading, curvature};
  pieces_.push_back(std::move(piece));
  length_ += length;
  end_ = on_piece(pieces_.back(), length_);
  return *this;
}

Path& Path::append(const Polynomial& polynomial) {
  Piece piece;
  piece.begin = length_;
  piece.is_arc = false;
  piece.polynomial = polynomial;
  piece.table.assign(1, 0.0);
  for (std::size_t i = 0; i < kParts; ++i) {
    const double p = static_cast<double>(i) / kParts;
    piece.table.push_back(piece.table.back() + arc_length(polynomial, p, p + 1.0 / kParts));
  }
  piece.length = piece.table.back();
  for (std::size_t i = 0; i <= 4 * kParts; ++i) {
    if (!(speed(polynomial, static_cast<double>(i) / (4 * kParts)) > 1e-6 * piece.length)) {
      throw InputError("path", fmt::format("stands still {:.4g} m from its beginning, where its direction is unknown",
                                           length_ + piece.length * static_cast<double>(i) / (4 * kParts)));
    }
  }
  const Derivatives x = evaluate(polynomial.x, 0.0), y = evaluate(polynomial.y, 0.0);
  piece.heading = std::atan2(y.first, x.first);
  if (pieces_.empty()) {
    start_ = {x.value, y.value, piece.heading, 0.0};
  } else {
    piece.heading = nearest_turn(piece.heading, end_.heading);
  }
  length_ += piece.length;
  pieces_.push_back(std::move(piece));
  end_ = on_piece(pieces_.back(), length_);
  return *this;
}

Path& Path::append_lane_change(double length, double offset) {
  const double c = std::cos(end_.heading), s = std::sin(end_.heading);
  const std::array<double, 6> along{0.0, length, 0.0, 0.0, 0.0, 0.0};
  const std::array<double, 6> side{0.0, 0.0, 0.0, 10.0 * offset, -15.0 * offset, 6.0 * offset};
  Polynomial piece;
  for (std::size_t k = 0; k < 6; ++k) {
    piece.x[k] = c * along[k] - s * side[k];
    piece.y[k] = s * along[k] + c * side[k];
  }
  piece.x[0] += end_.x;
  piece.y[0] += end_.y;
  return append(piece);
}

void Path::close() {
  const double turn = nearest_turn(start_.heading, end_.heading) - end_.heading;
  VERIDYN_ASSERT(std::hypot(end_.x - start_.x, end_.y - start_.y) < 1e-3 * length_ && std::abs(turn) < 1e-3);
  closed_ = true;
}

Path Path::from_origin() const {
  Path moved = *this;
  const double c = std::cos(start_.heading), s = std::sin(start_.heading);
  const auto move = [&](PathPoint& point) {
    const double dx = point.x - start_.x, dy = point.y - start_.y;
    point.x = c * dx + s * dy;
    point.y = c * dy - s * dx;
    point.heading -= start_.heading;
  };
  for (Piece& piece : moved.pieces_) {
    move(piece.start);
    piece.heading -= start_.heading;
    Polynomial turned;
    for (std::size_t k = 0; k < 6; ++k) {
      const double x = piece.polynomial.x[k] - (k == 0 ? start_.x : 0.0);
      const double y = piece.polynomial.y[k] - (k == 0 ? start_.y : 0.0);
      turned.x[k] = c * x + s * y;
      turned.y[k] = c * y - s * x;
    }
    piece.polynomial = turned;
  }
  move(moved.start_);
  move(moved.end_);
  return moved;
}

Path Path::circle(double radius, int direction) {
  VERIDYN_ASSERT(radius > 0.0 && direction != 0);
  Path path;
  path.append_arc(2.0 * kPi * radius, (direction > 0 ? 1.0 : -1.0) / radius);
  path.close();
  return path;
}

Path Path::through(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size()) throw InputError("path", fmt::format("has {} x and {} y", x.size(), y.size()));
  if (x.size() < 4) throw InputError("path", fmt::format("has {} points; must have at least 4", x.size()));
  std::vector<double> chord{0.0};
  for (std::size_t i = 1; i < x.size(); ++i) {
    const double distance = std::hypot(x[i] - x[i - 1], y[i] - y[i - 1]);
    if (!(distance > 0.0 && std::isfinite(distance))) {
      throw InputError("path", fmt::format("points {} and {} coincide or are not finite", i, i + 1));
    }
    chord.push_back(chord.back() + distance);
  }
  using numerics::PiecewisePolynomial;
  const PiecewisePolynomial along = PiecewisePolynomial::quintic_spline(chord, x);
  const PiecewisePolynomial across = PiecewisePolynomial::quintic_spline(chord, y);
  const auto at = [&](const PiecewisePolynomial& spline, double t, double step) {
    const numerics::FunctionValue<double> v = spline.evaluate(t);
    return Derivatives{v.value, v.slope * step, v.curvature * step * step};
  };
  Path path(x[0], y[0]);
  for (std::size_t i = 1; i < x.size(); ++i) {
    const double step = chord[i] - chord[i - 1];
    path.append({hermite(at(along, chord[i - 1], step), at(along, chord[i], step)),
                 hermite(at(across, chord[i - 1], step), at(across, chord[i], step))});
  }
  return path;
}

PathPoint Path::on_piece(const Piece& piece, double s) const {
  const double ahead = s - piece.begin;
  if (piece.is_arc) {
    const PathPoint& at = piece.start;
    const double turn = at.curvature * ahead;
    // sin(turn/2)/(turn/2), 1 for a straight line.
    const double half = 0.5 * turn;
    const double chord = ahead * (std::abs(half) < 1e-4 ? 1.0 - half * half / 6.0 : std::sin(half) / half);
    return {at.x + chord * std::cos(at.heading + half), at.y + chord * std::sin(at.heading + half), at.heading + turn,
            at.curvature};
  }
  const auto after = std::upper_bound(piece.table.begin() + 1, piece.table.end() - 1, ahead);
  const auto i = static_cast<std::size_t>(after - piece.table.begin()) - 1;
  const double p0 = static_cast<double>(i) / kParts;
  double p = p0 + (ahead - piece.table[i]) / (piece.table[i + 1] - piece.table[i]) / kParts;
  for (int k = 0; k < 4; ++k) {
    const double step = (ahead - piece.table[i] - arc_length(piece.polynomial, p0, p)) / speed(piece.polynomial, p);
    p += step;
    if (std::abs(step) < 1e-14) break;
  }
  const Derivatives x = evaluate(piece.polynomial.x, p), y = evaluate(piece.polynomial.y, p);
  const double v2 = x.first * x.first + y.first * y.first;
  // A piece of the fifth degree may turn by more than half a turn; its tables of heading would be needed to follow it,
  // but pieces between samples or of lane changes do not.
  return {x.value, y.value, nearest_turn(std::atan2(y.first, x.first), piece.heading),
          (x.first * y.second - y.first * x.second) / (v2 * std::sqrt(v2))};
}

PathPoint Path::at(double s) const {
  if (pieces_.empty())
    return {start_.x + s * std::cos(start_.heading), start_.y + s * std::sin(start_.heading), start_.heading, 0.0};
  double turns = 0.0;
  if (closed_) {
    const double laps = std::floor(s / length_);
    s -= laps * length_;
    turns = laps * 2.0 * kPi * std::round((end_.heading - start_.heading) / (2.0 * kPi));
  } else if (s < 0.0 || s > length_) {
    const PathPoint& from = s < 0.0 ? start_ : end_;
    const double beyond = s < 0.0 ? s : s - length_;
    return {from.x + beyond * std::cos(from.heading), from.y + beyond * std::sin(from.heading), from.heading, 0.0};
  }
  const auto after = std::upper_bound(pieces_.begin() + 1, pieces_.end(), s,
                                      [](double value, const Piece& piece) { return value < piece.begin; });
  PathPoint point = on_piece(*(after - 1), s);
  point.heading += turns;
  return point;
}

double Path::nearest(double x, double y, double guess, double window) const {
  const auto distance = [&](double s) {
    const PathPoint q = at(s);
    return std::hypot(x - q.x, y - q.y);
  };
  constexpr int kSamples = 8;
  double best = guess;
  double least = distance(guess);
  for (int i = -kSamples; i <= kSamples; ++i) {
    const double s = guess + window * i / kSamples;
    if (const double d = distance(s); d < least) {
      least = d;
      best = s;
    }
  }
  for (int k = 0; k < 12; ++k) {
    const PathPoint q = at(best);
    const double c = std::cos(q.heading), s = std::sin(q.heading);
    const double along = (x - q.x) * c + (y - q.y) * s;
    const double left = (y - q.y) * c - (x - q.x) * s;
    const double step =
        std::clamp(along / std::max(0.1, 1.0 - q.curvature * left), -window / kSamples, window / kSamples);
    best += step;
    if (std::abs(step) < 1e-10) break;
  }
  return best;
}

double Path::nearest(double x, double y) const {
  const int samples = std::max(100, static_cast<int>(pieces_.size()) * 8);
  double best = 0.0, least = kInfinity;
  for (int i = 0; i <= samples; ++i) {
    const double s = length_ * i / samples;
    const PathPoint q = at(s);
    if (const double d = std::hypot(x - q.x, y - q.y); d < least) {
      least = d;
      best = s;
    }
  }
  return nearest(x, y, best, 2.0 * length_ / samples);
}

}  // namespace veridyn::vehicle
