#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <type_traits>

#include "veridyn/vehicle/wheels.hpp"

namespace veridyn::vehicle {

/// A number for each of the four wheels, to calculate with: element by element, vectorised for double.
template <typename Scalar>
using WheelArray = Eigen::Array<Scalar, 4, 1>;

/// The sum over the wheels of an array whose wheels come in pairs, left and right: equal to the last bit when left and
/// right are exchanged.
template <typename Scalar>
[[nodiscard]] Scalar sum_of_wheels(const WheelArray<Scalar>& x) {
  return (x[0] + x[1]) + (x[2] + x[3]);
}

namespace internal {

/// atan(x)/x over z = x^2 up to 0.35^2, lowest power first: our own Chebyshev fit in 50 digits, error 1.1e-18.
inline constexpr std::array<double, 11> kSmallAtan{1.0,
                                                   -0.3333333333333312,
                                                   0.19999999999930973,
                                                   -0.1428571427688541,
                                                   0.11111110530571199,
                                                   -0.09090886751263585,
                                                   0.07691769336639785,
                                                   -0.06658275469120925,
                                                   0.05797294410193609,
                                                   -0.04714585275313757,
                                                   0.02641198278200618};
inline constexpr double kSmallAtanMost = 0.35;

}  // namespace internal

/// atan of four numbers. For double within 2 units in the last place; odd to the last bit. Slip angles are small: up
/// to 0.35 (19 deg) all four cost less than one call of the library, beyond they cost a call each.
template <typename Scalar>
[[nodiscard]] WheelArray<Scalar> atan_of_wheels(const WheelArray<Scalar>& x) {
  using std::atan;
  if constexpr (std::is_same_v<Scalar, double>) {
    if (x.abs().maxCoeff() <= internal::kSmallAtanMost) {
      const auto& c = internal::kSmallAtan;
      const WheelArray<double> z = x * x, z2 = z * z, z4 = z2 * z2;
      // After Estrin: short chains of operations, which the processor overlaps.
      const WheelArray<double> low = (c[1] * z + c[2] * z2) + z2 * (c[3] * z + c[4] * z2);
      const WheelArray<double> high = (c[5] + c[6] * z) + z2 * (c[7] + c[8] * z) + z4 * (c[9] + c[10] * z);
      return x + x * (low + (z4 * z) * high);
    }
  }
  WheelArray<Scalar> out;
  for (Eigen::Index i = 0; i < 4; ++i) out[i] = atan(x[i]);
  return out;
}

}  // namespace veridyn::vehicle
