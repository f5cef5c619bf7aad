#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <type_traits>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/trigonometry.hpp"

/// Compiles a function for wider registers too, which are taken where the processor has them: without fused
/// multiplication, so that results are the same.
#if defined(__x86_64__) && !defined(__clang__)
#define VERIDYN_WIDE [[gnu::target_clones("avx2", "default")]]
#else
#define VERIDYN_WIDE
#endif

// Vectors of four doubles are passed between functions that are all inlined. (Not switched on again: the compiler asks
// at the end of a source.)
#pragma GCC diagnostic ignored "-Wpsabi"

/// Numbers of four wheels in the lanes of a vector, and functions of them without branches on single lanes: always
/// inlined, so that they become part of what is compiled for wider registers.
namespace veridyn::vehicle::in_lanes {

/// A number of each wheel.
using Four = double __attribute__((vector_size(32)));
/// Their bits, and what comparisons give.
using FourBits = long long __attribute__((vector_size(32)));

/// Numbers that do not change.
[[gnu::always_inline]] inline Four from(const double* numbers) {
  Four x;
  std::memcpy(&x, numbers, sizeof x);
  return x;
}
/// Numbers just written, in halves as registers of two wrote them: a processor hands a store on only to a load that
/// lies within it; one of all four would wait for the cache.
[[gnu::always_inline]] inline Four from_halves(const double* numbers) {
  using Two = double __attribute__((vector_size(16)));
  Two low, high;
  std::memcpy(&low, numbers, sizeof low);
  std::memcpy(&high, numbers + 2, sizeof high);
  return __builtin_shufflevector(low, high, 0, 1, 2, 3);
}
/// @cond arithmetic of lanes: each function is what its name says
[[gnu::always_inline]] inline Four all(double x) { return Four{} + x; }
[[gnu::always_inline]] inline FourBits bits_of(Four x) {
  FourBits bits;
  std::memcpy(&bits, &x, sizeof x);
  return bits;
}
[[gnu::always_inline]] inline Four number_of(FourBits bits) {
  Four x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}
[[gnu::always_inline]] inline Four larger(Four a, Four b) { return a > b ? a : b; }
[[gnu::always_inline]] inline Four smaller(Four a, Four b) { return a < b ? a : b; }
[[gnu::always_inline]] inline Four clamped(Four x, Four lowest, Four highest) {
  return smaller(larger(x, lowest), highest);
}
[[gnu::always_inline]] inline Four size_of(Four x) { return number_of(bits_of(x) & 0x7fffffffffffffffLL); }
[[gnu::always_inline]] inline Four sign_of(Four x) { return x < 0.0 ? all(-1.0) : all(1.0); }
/// A number that is not negative, or of the same sign, with the sign of another.
[[gnu::always_inline]] inline Four with_sign_of(Four size, Four x) {
  return number_of(bits_of(size) | (bits_of(x) & ~0x7fffffffffffffffLL));
}
[[gnu::always_inline]] inline Four where(FourBits is, Four then, Four other) { return is ? then : other; }
[[gnu::always_inline]] inline FourBits at_most(Four x, double most) { return x <= most; }

/// Whether a comparison holds in every lane, or in any.
[[gnu::always_inline]] inline int lanes_of(FourBits is) {
#if defined(__SSE2__)
  __m128d low, high;
  std::memcpy(&low, &is, sizeof low);
  std::memcpy(&high, reinterpret_cast<const char*>(&is) + sizeof low, sizeof high);
  return _mm_movemask_pd(low) | _mm_movemask_pd(high) << 2;
#else
  return static_cast<int>((is[0] & 1) | (is[1] & 2) | (is[2] & 4) | (is[3] & 8));
#endif
}
[[gnu::always_inline]] inline bool every(FourBits is) { return lanes_of(is) == 15; }
[[gnu::always_inline]] inline bool any(FourBits is) { return lanes_of(is) != 0; }

/// Square roots, rounded correctly.
[[gnu::always_inline]] inline Four root(Four x) {
#if defined(__SSE2__)
  // Two by two: a call of std::sqrt asks for negative numbers, one by one.
  __m128d low, high;
  std::memcpy(&low, &x, sizeof low);
  std::memcpy(&high, reinterpret_cast<const char*>(&x) + sizeof low, sizeof high);
  low = _mm_sqrt_pd(low), high = _mm_sqrt_pd(high);
  return __builtin_shufflevector(low, high, 0, 1, 2, 3);
#else
  return Four{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
#endif
}

/// @endcond

/// Both directions of four tyres: two chains of operations, side by side, which the processor overlaps.
struct Both {
  Four x, y;
};
/// Their bits, and what comparisons give.
struct BothBits {
  FourBits x, y;
};
/// @cond the same arithmetic of both
[[gnu::always_inline]] inline Both operator+(Both a, Both b) { return {a.x + b.x, a.y + b.y}; }
[[gnu::always_inline]] inline Both operator-(Both a, Both b) { return {a.x - b.x, a.y - b.y}; }
[[gnu::always_inline]] inline Both operator*(Both a, Both b) { return {a.x * b.x, a.y * b.y}; }
[[gnu::always_inline]] inline Both operator/(Both a, Both b) { return {a.x / b.x, a.y / b.y}; }
[[gnu::always_inline]] inline Both operator*(Both a, Four b) { return {a.x * b, a.y * b}; }
[[gnu::always_inline]] inline Both operator+(double a, Both b) { return {a + b.x, a + b.y}; }
[[gnu::always_inline]] inline Both operator-(double a, Both b) { return {a - b.x, a - b.y}; }
[[gnu::always_inline]] inline Both operator-(Both a, double b) { return {a.x - b, a.y - b}; }
[[gnu::always_inline]] inline Both operator*(double a, Both b) { return {a * b.x, a * b.y}; }
[[gnu::always_inline]] inline Both size_of(Both a) { return {size_of(a.x), size_of(a.y)}; }
[[gnu::always_inline]] inline Both sign_of(Both a) { return {sign_of(a.x), sign_of(a.y)}; }
[[gnu::always_inline]] inline Both smaller(Both a, Both b) { return {smaller(a.x, b.x), smaller(a.y, b.y)}; }
[[gnu::always_inline]] inline BothBits at_most(Both a, double b) { return {a.x <= b, a.y <= b}; }
[[gnu::always_inline]] inline bool every(BothBits is) { return every(is.x & is.y); }
[[gnu::always_inline]] inline Both where(BothBits is, Both then, Both other) {
  return {where(is.x, then.x, other.x), where(is.y, then.y, other.y)};
}
[[gnu::always_inline]] inline Both with_sign_of(Both size, Both x) {
  return {with_sign_of(size.x, x.x), with_sign_of(size.y, x.y)};
}
/// @endcond

/// The same number in all lanes.
template <typename Lanes>
[[gnu::always_inline]] inline Lanes number(double x) {
  if constexpr (std::is_same_v<Lanes, Both>) {
    return {all(x), all(x)};
  } else {
    return all(x);
  }
}

/// x + x z p(z) over z = x^2: the arc tangents of numbers of at most 0.35.
template <typename Lanes>
[[gnu::always_inline]] inline Lanes arc_tangent_of_small(Lanes x) {
  const auto& c = numerics::internal::kArcTangent;
  const Lanes z = x * x, z2 = z * z, z4 = z2 * z2;
  const Lanes low = (c[0] + c[1] * z) + z2 * (c[2] + c[3] * z);
  const Lanes high = (c[4] + c[5] * z) + z2 * (c[6] + c[7] * z) + z4 * (c[8] + c[9] * z);
  return x + (x * z) * (low + z4 * high);
}

/// Arc tangents of any numbers, within 2 units in the last place and odd to the last bit. By atan(x) = atan(c) +
/// atan((x - c)/(1 + c x)) with a c that leaves at most 0.35; where all are as small at once, without it, which gives
/// the same bits in half the time.
template <typename Lanes>
[[gnu::always_inline]] inline Lanes arc_tangent(Lanes x) {
  constexpr double kNear = 0.75, kFar = 2.2;
  constexpr double kAngleOfNear = 0.6435011087932844, kAngleOfFar = 1.1441688336680205;
  const auto of = [](double v) __attribute__((always_inline)) { return number<Lanes>(v); };
  const Lanes a = size_of(x);
  const auto small = at_most(a, numerics::internal::kArcTangentMost);
  if (every(small)) return with_sign_of(arc_tangent_of_small(x), x);  // that of -0, too
  const auto near = at_most(a, 1.1), far = at_most(a, 9.0);
  const Lanes centre = where(small, of(0.0), where(near, of(kNear), of(kFar)));
  const Lanes base = where(small, of(0.0), where(near, of(kAngleOfNear), where(far, of(kAngleOfFar), of(kPi / 2.0))));
  const Lanes y = where(far, a - centre, of(-1.0)) / where(far, 1.0 + centre * a, a);
  return with_sign_of(base + arc_tangent_of_small(y), x);
}

/// Added to a number, rounds it and leaves the whole number in its last bits: 1.5 2^52.
inline constexpr double kRounds = 6755399441055744.0;

/// +-1 by a bit of the lanes that leaves the sign as it is or turns it.
[[gnu::always_inline]] inline Four turned(Four x, FourBits quarter) {
  constexpr int kToSign = 62;
  return number_of(bits_of(x) ^ ((quarter & 2) << kToSign));
}
/// Cosines where the quarter is odd, else sines, with the sign of the quarter.
[[gnu::always_inline]] inline Four cosine_in_odd_quarters(Four sine, Four cosine, FourBits quarter) {
  return turned((quarter & 1) != 0 ? cosine : sine, quarter);
}
/// The same of both.
[[gnu::always_inline]] inline Both cosine_in_odd_quarters(Both sine, Both cosine, BothBits quarter) {
  return {cosine_in_odd_quarters(sine.x, cosine.x, quarter.x), cosine_in_odd_quarters(sine.y, cosine.y, quarter.y)};
}
/// The bits of both.
[[gnu::always_inline]] inline BothBits bits_of(Both x) { return {bits_of(x.x), bits_of(x.y)}; }

/// Sines of up to 1e5 rad, within 1 unit in the last place of 1 and odd to the last bit, see `numerics::sine_cosine`;
/// where all are below pi/4 at once, the series of sines alone gives the same bits in half the time.
template <typename Lanes>
[[gnu::always_inline]] inline Lanes sine(Lanes x) {
  const auto sine_of_small = [](Lanes y, Lanes z, Lanes z2, Lanes z4) __attribute__((always_inline)) {
    const auto& a = numerics::internal::kSine;
    return y + (y * z) * ((a[0] + a[1] * z) + z2 * (a[2] + a[3] * z) + z4 * (a[4] + a[5] * z));
  };
  if (every(at_most(size_of(x), 0.78))) {
    const Lanes z = x * x, z2 = z * z;
    return sine_of_small(x, z, z2, z2 * z2);
  }
  // Less the nearest multiple of pi/2, whose first 33 bits times a multiple are exact.
  const Lanes rounded = kRounds + 0.63661977236758134 * x, k = rounded - kRounds;
  const Lanes y = (x - 1.5707963267341256 * k) - 6.077100506506192e-11 * k;
  const Lanes z = y * y, z2 = z * z, z4 = z2 * z2;
  const auto& b = numerics::internal::kCosine;
  const Lanes c = (1.0 - 0.5 * z) + z2 * ((b[0] + b[1] * z) + z2 * (b[2] + b[3] * z) + z4 * (b[4] + b[5] * z));
  return cosine_in_odd_quarters(sine_of_small(y, z, z2, z4), c, bits_of(rounded));
}

/// e^x, up to 700: 2^k times the power series of what is left, at most half of ln 2, which is in two parts.
[[gnu::always_inline]] inline Four exponential(Four x) {
  const Four rounded = clamped(x, all(-700.0), all(700.0)) * 1.4426950408889634 + kRounds;
  const Four k = rounded - kRounds;
  const Four r = (x - k * 0.693147180369123816490) - k * 1.90821492927058770002e-10;
  constexpr std::array<double, 14> c = [] {
    std::array<double, 14> of{1.0};
    for (std::size_t n = 1; n < of.size(); ++n) of[n] = of[n - 1] / static_cast<double>(n);
    return of;
  }();
  const Four r2 = r * r, r4 = r2 * r2;
  const Four low = (c[0] + c[1] * r) + r2 * (c[2] + c[3] * r), middle = (c[4] + c[5] * r) + r2 * (c[6] + c[7] * r);
  const Four high = (c[8] + c[9] * r) + r2 * (c[10] + c[11] * r) + r4 * (c[12] + c[13] * r);
  const Four sum = low + r4 * (middle + r4 * high);
  constexpr int kMantissa = 52;
  return sum * number_of((bits_of(rounded) << kMantissa) + bits_of(all(1.0)));
}

}  // namespace veridyn::vehicle::in_lanes
