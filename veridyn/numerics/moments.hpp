#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace veridyn::numerics {

/// Mean of all values, added in their order; 0 when there are none.
[[nodiscard]] inline double mean(std::span<const double> x) {
  return x.empty() ? 0.0 : std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

/// Sums of samples as they come, where one pass over them is all there is. Of a mean that is large beside the deviation
/// the squares cancel: nothing for statistics that decide to the last digits.
struct Moments {
  double count = 0.0, sum = 0.0, squares = 0.0;

  void add(double x) {
    count += 1.0;
    sum += x;
    squares += x * x;
  }
  [[nodiscard]] double mean() const { return count > 0.0 ? sum / count : 0.0; }
  [[nodiscard]] double rms() const { return count > 0.0 ? std::sqrt(squares / count) : 0.0; }
  /// Of the samples themselves: divided by their number.
  [[nodiscard]] double sd() const {
    return count > 0.0 ? std::sqrt(std::max(0.0, squares / count - mean() * mean())) : 0.0;
  }
};

}  // namespace veridyn::numerics
