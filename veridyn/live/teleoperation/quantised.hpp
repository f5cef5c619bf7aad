#pragma once

#include <cmath>
#include <limits>

namespace veridyn::live {

/// The nearest number of steps that `Integer` can hold; 0 for what is none.
template <class Integer>
[[nodiscard]] Integer quantised(double value, double step) {
  const double steps = std::nearbyint(value / step);
  if (!(steps == steps)) return 0;
  constexpr auto lowest = static_cast<double>(std::numeric_limits<Integer>::min());
  constexpr auto highest = static_cast<double>(std::numeric_limits<Integer>::max());
  return static_cast<Integer>(std::fmin(std::fmax(steps, lowest), highest));
}

}  // namespace veridyn::live
