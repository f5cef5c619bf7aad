#pragma once

#include <cmath>

namespace veridyn::numerics {

/// A signal less its own first-order lag, y = T s/(1 + T s) x, after a time in which x changed linearly by `change`:
/// exact, y(t) = y e^-theta + change (1 - e^-theta)/theta.
/// @param theta  that time over the lag's time constant T, >= 0
template <typename Scalar>
[[nodiscard]] Scalar washed_out(const Scalar& y, const Scalar& change, const Scalar& theta) {
  using std::exp;
  using std::expm1;
  if (!(theta > Scalar(0.0))) return y + change;
  return exp(-theta) * y + change * (-expm1(-theta) / theta);
}

}  // namespace veridyn::numerics
