#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace veridyn::vehicle {

/// A function of time through samples, straight between them, constant beyond the ends.
class PiecewiseLinear {
 public:
  PiecewiseLinear() = default;
  /// The same value at all times.
  explicit PiecewiseLinear(double constant);
  /// @throws InputError unless as many times as values, times strictly increasing, all finite.
  PiecewiseLinear(std::vector<double> time, std::vector<double> value);

  /// 0 when there are no samples. Does not allocate.
  [[nodiscard]] double operator()(double time) const;
  /// Without samples.
  [[nodiscard]] bool empty() const { return time_.empty(); }
  [[nodiscard]] std::span<const double> times() const { return time_; }
  [[nodiscard]] std::span<const double> values() const { return value_; }

 private:
  std::vector<double> time_, value_;
};

}  // namespace veridyn::vehicle
