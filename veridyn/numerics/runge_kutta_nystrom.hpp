#pragma once

#include <cstddef>

namespace veridyn::numerics {

/// Steps of Nystroem's method of order five with four evaluations for x'' = f(x), without x' on the right (Hairer,
/// Norsett & Wanner, Solving Ordinary Differential Equations I, table II.14.2). Global error O(h^5).
///
/// No step size is left in the formulas: `u` is h x', and `scaled_acceleration(const Scalar* x, Scalar* k)` writes
/// k = h^2 f(x). Arrays of scalars, not matrices: for hot loops on jets nothing is shuffled. Neither throws nor
/// allocates.
/// @param x, u  `kSize` values each, changed in place
template <std::size_t kSize, typename Scalar, typename Acceleration>
void nystrom_5_steps(const Acceleration& scaled_acceleration, int steps, Scalar* x, Scalar* u) {
  Scalar at[kSize], k1[kSize], k2[kSize], k3[kSize], k4[kSize];
  for (int i = 0; i < steps; ++i) {
    scaled_acceleration(x, k1);
    for (std::size_t c = 0; c < kSize; ++c) at[c] = x[c] + (u[c] * 0.2 + k1[c] * (1.0 / 50.0));
    scaled_acceleration(at, k2);
    for (std::size_t c = 0; c < kSize; ++c)
      at[c] = x[c] + (u[c] * (2.0 / 3.0) - k1[c] * (1.0 / 27.0)) + k2[c] * (7.0 / 27.0);
    scaled_acceleration(at, k3);
    for (std::size_t c = 0; c < kSize; ++c)
      at[c] = x[c] + (u[c] + k1[c] * (21.0 / 70.0) - k2[c] * (4.0 / 70.0)) + k3[c] * (18.0 / 70.0);
    scaled_acceleration(at, k4);
    for (std::size_t c = 0; c < kSize; ++c) {
      x[c] += u[c] + (k1[c] * (14.0 / 336.0) + k2[c] * (100.0 / 336.0) + k3[c] * (54.0 / 336.0));
      u[c] += k1[c] * (14.0 / 336.0) + k2[c] * (125.0 / 336.0) + k3[c] * (162.0 / 336.0) + k4[c] * (35.0 / 336.0);
    }
  }
}

}  // namespace veridyn::numerics
