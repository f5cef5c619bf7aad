#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace veridyn::numerics {

/// Value and derivatives of a spline.
struct SplineValue {
  double value = 0.0;
  double first = 0.0;
  double second = 0.0;
};

/// The quintic spline through samples (de Boor 2001, chapter XIII): four times continuously differentiable, so that
/// second derivatives of a recorded motion are smooth; not-a-knot at the ends, so that no condition is invented there.
/// With fewer than six samples a cubic (from four on) or a broken line.
///
/// Beyond its ends the first and the last value hold.
class InterpolatingSpline {
 public:
  InterpolatingSpline() = default;
  /// `times` strictly increasing, at least one; as many values. The caller has checked them for NaN.
  InterpolatingSpline(std::span<const double> times, std::span<const double> values);

  /// The piecewise polynomial sum_k coefficients[i][k] (t - breaks[i])^k from breaks[i] on, the last piece until `end`.
  /// `breaks` strictly increasing, at least one, as many coefficients; smoothness is that of the pieces given.
  [[nodiscard]] static InterpolatingSpline from_pieces(std::vector<double> breaks,
                                                       std::vector<std::array<double, 6>> coefficients, double end);

  /// At a break the piece that begins there counts.
  [[nodiscard]] SplineValue evaluate(double time) const;
  [[nodiscard]] double begin() const { return breaks_.front(); }
  [[nodiscard]] double end() const { return end_; }

 private:
  static constexpr std::size_t kOrder = 6;
  std::vector<double> breaks_;                            ///< where pieces begin
  std::vector<std::array<double, kOrder>> coefficients_;  ///< ascending powers of time - break
  double end_ = 0.0;
};

}  // namespace veridyn::numerics
