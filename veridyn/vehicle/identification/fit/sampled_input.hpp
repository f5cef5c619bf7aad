#pragma once

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace veridyn::vehicle {

/// The value of a number without derivatives: itself.
[[nodiscard]] inline double sampled_value(double x) { return x; }
/// The value of one with derivatives.
template <int kN>
[[nodiscard]] double sampled_value(const ceres::Jet<double, kN>& x) {
  return x.a;
}

/// A sampled input between its samples: cubic through the four neighbours (Catmull-Rom), so that shifts in time have a
/// derivative.
struct SampledInput {
  std::span<const double> value;
  double step = 0.01;

  /// At `position` [samples from the first]; the end values hold outside.
  template <typename Scalar>
  [[nodiscard]] Scalar at(const Scalar& position) const {
    const auto n = value.size();
    const double p = std::clamp(sampled_value(position), 0.0, static_cast<double>(n - 1));
    if (n == 1) return Scalar(value[0]);
    const auto i = std::min(static_cast<std::size_t>(p), n - 2);
    const double s = p - static_cast<double>(i);
    const double y1 = value[i], y2 = value[i + 1];
    const double y0 = i > 0 ? value[i - 1] : 2.0 * y1 - y2;
    const double y3 = i + 2 < n ? value[i + 2] : 2.0 * y2 - y1;
    const double c1 = y2 - y0, c2 = 2.0 * y0 - 5.0 * y1 + 4.0 * y2 - y3, c3 = 3.0 * (y1 - y2) + y3 - y0;
    const double y = y1 + 0.5 * s * (c1 + s * (c2 + s * c3));
    if (p != sampled_value(position)) return Scalar(y);
    const double slope = 0.5 * (c1 + s * (2.0 * c2 + 3.0 * s * c3));
    return Scalar(y) + slope * (position - p);
  }
};

/// Between `samples` at `position`, cubic.
template <typename Value, typename Scalar>
Scalar between(const std::vector<Value>& samples, const Scalar& position) {
  const auto last = static_cast<double>(samples.size() - 1);
  const double p = std::clamp(sampled_value(position), 0.0, last);
  const auto i = static_cast<std::size_t>(std::min(std::floor(p), std::max(0.0, last - 1.0)));
  if (samples.size() == 1) return Scalar(samples[0]);
  const Value& y1 = samples[i];
  const Value& y2 = samples[i + 1];
  const Value y0 = i > 0 ? samples[i - 1] : Value(2.0 * y1 - y2);
  const Value y3 = i + 2 < samples.size() ? samples[i + 2] : Value(2.0 * y2 - y1);
  Scalar s = position - static_cast<double>(i);
  if (sampled_value(position) < 0.0 || sampled_value(position) > last) s = Scalar(p - static_cast<double>(i));
  return y1 + 0.5 * s * (y2 - y0 + s * (2.0 * y0 - 5.0 * y1 + 4.0 * y2 - y3 + s * (3.0 * (y1 - y2) + y3 - y0)));
}

}  // namespace veridyn::vehicle
