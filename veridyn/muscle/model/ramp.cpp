#include "veridyn/muscle/model/ramp.hpp"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {
namespace {

using Piece = std::array<double, 6>;

/// The quintic with given values, first and second derivatives at both ends of [0, h].
Piece hermite(double h, const numerics::FunctionValue<double>& a, const numerics::FunctionValue<double>& b) {
  const double r0 = b.value - a.value - h * (a.slope + 0.5 * h * a.curvature);
  const double r1 = h * (b.slope - a.slope - h * a.curvature);
  const double r2 = h * h * (b.curvature - a.curvature);
  const double h3 = h * h * h;
  return {a.value,
          a.slope,
          0.5 * a.curvature,
          (10.0 * r0 - 4.0 * r1 + 0.5 * r2) / h3,
          (-15.0 * r0 + 7.0 * r1 - r2) / (h3 * h),
          (6.0 * r0 - 3.0 * r1 + 0.5 * r2) / (h3 * h * h)};
}

numerics::FunctionValue<double> half_sine(const Ramp& ramp, double s) {
  const double rate = kPi / ramp.duration;
  const double half = 0.5 * (ramp.to - ramp.from), angle = kPi * s;
  return {ramp.from + half * (1.0 - std::cos(angle)), half * rate * std::sin(angle),
          half * rate * rate * std::cos(angle)};
}

void append(const Ramp& ramp, std::vector<double>& breaks, std::vector<Piece>& pieces) {
  const double rise = ramp.to - ramp.from, d = ramp.duration;
  if (ramp.shape == RampShape::kHalfSine) {
    constexpr int kPieces = 64;
    for (int i = 0; i < kPieces; ++i) {
      breaks.push_back(ramp.start + d * i / kPieces);
      pieces.push_back(hermite(d / kPieces, half_sine(ramp, static_cast<double>(i) / kPieces),
                               half_sine(ramp, static_cast<double>(i + 1) / kPieces)));
    }
    return;
  }
  breaks.push_back(ramp.start);
  if (ramp.shape == RampShape::kLinear) {
    pieces.push_back({ramp.from, rise / d});
  } else {
    const double k = rise / (d * d * d);
    pieces.push_back({ramp.from, 0.0, 0.0, 10.0 * k, -15.0 * k / d, 6.0 * k / (d * d)});
  }
}

}  // namespace

numerics::PiecewisePolynomial ramp_spline(std::span<const Ramp> ramps) {
  VERIDYN_ASSERT(!ramps.empty());
  std::vector<double> breaks;
  std::vector<Piece> pieces;
  double end = ramps.front().start;
  for (const Ramp& ramp : ramps) {
    VERIDYN_ASSERT(ramp.duration > 0.0 && ramp.start >= end);
    if (!pieces.empty() && ramp.start > end) {
      breaks.push_back(end);
      pieces.push_back({ramp.from});
    }
    append(ramp, breaks, pieces);
    end = ramp.start + ramp.duration;
  }
  breaks.push_back(end);
  pieces.push_back({ramps.back().to});
  return numerics::PiecewisePolynomial::held_pieces(breaks, pieces, end);
}

numerics::PiecewisePolynomial resting_spline(double value) {
  return numerics::PiecewisePolynomial::held_pieces(std::vector{0.0}, std::vector<Piece>{{value}}, 0.0);
}

}  // namespace veridyn::muscle
