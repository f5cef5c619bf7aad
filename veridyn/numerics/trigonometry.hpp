#pragma once

#include <Eigen/Core>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>

/// Functions of angles, which in simulations are many and mostly small: inline, for the hot loops. Polynomials are
/// Chebyshev fits in 50 digits, with errors below 2e-17.
namespace veridyn::numerics {

/// Sine and cosine of one angle.
template <typename Scalar>
struct SineCosine {
  Scalar sin, cos;
};

/// Four angles or tangents, to calculate with element by element.
template <typename Scalar>
using FourAngles = Eigen::Array<Scalar, 4, 1>;

namespace internal {

/// (sin(x)/x - 1)/z and (cos(x) - 1 + z/2)/z^2 over z = x^2 up to (pi/4)^2, lowest power first.
inline constexpr std::array<double, 6> kSine{-0.16666666666666666,  0.008333333333330946,    -0.0001984126983675497,
                                             2.755731610068303e-06, -2.5051131455427946e-08, 1.591810123027412e-10};
inline constexpr std::array<double, 6> kCosine{0.041666666666666664,   -0.0013888888888887395,
                                               2.4801587298763433e-05, -2.7557317270560326e-07,
                                               2.0876146024689747e-09, -1.1382614868556325e-11};
/// atan(x)/x - 1 over z = x^2 up to 0.35^2, from the power of 1.
inline constexpr std::array<double, 10> kArcTangent{
    -0.3333333333333312, 0.19999999999930973,  -0.1428571427688541, 0.11111110530571199,  -0.09090886751263585,
    0.07691769336639785, -0.06658275469120925, 0.05797294410193609, -0.04714585275313757, 0.02641198278200618};
inline constexpr double kArcTangentMost = 0.35;

}  // namespace internal

/// Sine and cosine together. For double within 1 unit in the last place of 1 up to 1e5 rad (beyond, and for other
/// scalars, those of the library); odd and even to the last bit.
template <typename Scalar>
[[nodiscard, gnu::always_inline]] inline SineCosine<Scalar> sine_cosine(const Scalar& x) {
  using std::cos;
  using std::sin;
  if constexpr (std::is_same_v<Scalar, double>) {
    if (std::abs(x) < 1e5) {
      // The nearest multiple of pi/2: adding 1.5 2^52 rounds to a whole number and leaves it in the last bits. pi/2 is
      // in two parts of 33 bits, whose multiples are exact, and a rest.
      constexpr double kRound = 6755399441055744.0;
      const double rounded = x * 0.63661977236758134 + kRound;
      const auto quarter = std::bit_cast<std::uint64_t>(rounded);
      const double k = rounded - kRound;
      const double y = ((x - k * 1.5707963267341256) - k * 6.077100506303966e-11) - k * 2.0222662487959506e-21;
      const double z = y * y, z2 = z * z, z4 = z2 * z2;
      const auto& a = internal::kSine;
      const auto& b = internal::kCosine;
      const double s = y + (y * z) * ((a[0] + a[1] * z) + z2 * (a[2] + a[3] * z) + z4 * (a[4] + a[5] * z));
      const double c = (1.0 - 0.5 * z) + z2 * ((b[0] + b[1] * z) + z2 * (b[2] + b[3] * z) + z4 * (b[4] + b[5] * z));
      const double sine = (quarter & 1U) != 0 ? c : s, cosine = (quarter & 1U) != 0 ? s : c;
      return {(quarter & 2U) != 0 ? -sine : sine, ((quarter + 1) & 2U) != 0 ? -cosine : cosine};
    }
  }
  return {sin(x), cos(x)};
}

/// Arc tangents of four numbers. For double within 1 unit in the last place; odd to the last bit. Up to 0.35 (19 deg)
/// all four cost about one call of the library, beyond they cost a call each.
template <typename Scalar>
[[nodiscard, gnu::always_inline]] inline FourAngles<Scalar> arc_tangents(const FourAngles<Scalar>& x) {
  using std::atan;
  if constexpr (std::is_same_v<Scalar, double>) {
    constexpr double kLargest = internal::kArcTangentMost;
    if (std::abs(x[0]) <= kLargest && std::abs(x[1]) <= kLargest && std::abs(x[2]) <= kLargest &&
        std::abs(x[3]) <= kLargest) {
      const auto& c = internal::kArcTangent;
      const FourAngles<double> z = x * x, z2 = z * z, z4 = z2 * z2;
      // In short chains of operations, which the processor overlaps.
      const FourAngles<double> low = (c[0] + c[1] * z) + z2 * (c[2] + c[3] * z);
      const FourAngles<double> high = (c[4] + c[5] * z) + z2 * (c[6] + c[7] * z) + z4 * (c[8] + c[9] * z);
      return x + (x * z) * (low + z4 * high);
    }
  }
  FourAngles<Scalar> out;
  for (Eigen::Index i = 0; i < 4; ++i) out[i] = atan(x[i]);
  return out;
}

}  // namespace veridyn::numerics
