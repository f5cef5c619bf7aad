#include "veridyn/estimation/recursive/tracked_svd.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::estimation {
namespace {

// Angles below this are turned at once and not looked at again; what is left is their square.
constexpr double kLastAngle = 1e-6;
// Above this a turn of all columns at once would not be orthogonal to rounding (its error is angle^6/8).
constexpr double kLargestAngle = 0.01;
// Above this V is made orthonormal again at once.
constexpr double kCleanAngle = 1e-3;
// Below this it is so without the fourth power.
constexpr double kNoFourthPower = 1e-4;
// Cosines below this are rounding.
constexpr double kNoAngle = 4.0 * std::numeric_limits<double>::epsilon();
constexpr int kMostTurns = 60;
constexpr std::uint64_t kUpdatesPerCleaning = 64;

// Everything below is inlined into one function per size, which is compiled twice where processors differ: for those
// with AVX2 and fused multiply-add (twice as fast; last digits differ), and for all.
#define VERIDYN_INLINE [[gnu::always_inline]] inline
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)
#define VERIDYN_HAS_FAST_VERSION 1
#else
#define VERIDYN_HAS_FAST_VERSION 0
#endif

// Two doubles at a time (every x86-64 and ARMv8 has them): rows below are kept in registers while they are summed.
using Pair = double __attribute__((vector_size(16)));

template <int kColumns>
struct Row {
  static constexpr int kPairs = (kColumns + 1) / 2;
  Pair pair[kPairs];

  VERIDYN_INLINE static Row zero() {
    Row r;
    for (Pair& p : r.pair) p = Pair{0.0, 0.0};
    return r;
  }
  VERIDYN_INLINE void add(double a, const Row& x) {
    const Pair factor{a, a};
    for (int j = 0; j < kPairs; ++j) pair[j] += factor * x.pair[j];
  }
  VERIDYN_INLINE void scale(double a) {
    const Pair factor{a, a};
    for (Pair& p : pair) p *= factor;
  }
  VERIDYN_INLINE double operator()(int j) const { return pair[j / 2][j % 2]; }
  /// Slow: a pair must not be read soon after one of its halves was written.
  VERIDYN_INLINE void set(int j, double value) { pair[j / 2][j % 2] = value; }
};

template <int kColumns>
using Rows = std::array<Row<kColumns>, at(kColumns)>;

// a' b of the rows of two square matrices, the Gram matrix when they are the same.
template <int kColumns>
VERIDYN_INLINE void gram(const Rows<kColumns>& b, Rows<kColumns>& result) {
  for (std::size_t i = 0; i < kColumns; ++i) {
    Row<kColumns> sum = Row<kColumns>::zero();
    for (std::size_t k = 0; k < kColumns; ++k) sum.add(b[k](static_cast<int>(i)), b[k]);
    result[i] = sum;
  }
}

// y_i = scale x_i + factor sum_k a_ik b_k
template <int kColumns>
VERIDYN_INLINE void multiply(const Rows<kColumns>& a, const Rows<kColumns>& b, double factor, double scale,
                             const Rows<kColumns>& x, Rows<kColumns>& y) {
  for (std::size_t i = 0; i < kColumns; ++i) {
    Row<kColumns> sum = Row<kColumns>::zero();
    for (std::size_t k = 0; k < kColumns; ++k) sum.add(a[i](static_cast<int>(k)), b[k]);
    sum.scale(factor);
    sum.add(scale, x[i]);
    y[i] = sum;
  }
}

/// The angles of all pairs and what they allow.
struct Angles {
  double largest = 0.0;      ///< infinite for columns of equal length that are not orthogonal
  bool last_cosines = true;  ///< all cosines below kLastAngle
};

// K_ij = g_ij/(g_jj - g_ii), 0 where the columns are orthogonal to rounding: B = R V has errors of the size of its
// largest column, so cosines between columns that are nothing but such errors say nothing.
template <int kColumns>
VERIDYN_INLINE Angles angles_of(const Rows<kColumns>& G, const Row<kColumns>& power, Rows<kColumns>& K) {
  constexpr int kPairs = Row<kColumns>::kPairs;
  const Pair none{0.0, 0.0};
  Pair largest = none, excess = none;
  double most = 0.0;
  for (int i = 0; i < kColumns; ++i) most = std::max(most, power(i));
  const double level = kNoAngle * kNoAngle * most;
  const Pair rounding{level, level};
  for (std::size_t i = 0; i < kColumns; ++i) {
    const Pair current{power(static_cast<int>(i)), power(static_cast<int>(i))};
    for (int j = 0; j < kPairs; ++j) {
      const Pair d = G[i].pair[j];
      const Pair product = current * power.pair[j];
      const Pair longer = current > power.pair[j] ? current : power.pair[j];
      const Pair square = d * d;
      Pair difference = power.pair[j] - current;
      if (j == static_cast<int>(i) / 2) difference[static_cast<int>(i) % 2] = kInfinity;
      Pair k = d / difference;
      k = square > rounding * longer ? k : none;
      K[i].pair[j] = k;
      const Pair size = k < none ? -k : k;
      largest = size > largest ? size : largest;
      const Pair over = square - (kLastAngle * kLastAngle) * product;
      excess = k != none && over > excess ? over : excess;  // k is 0 on the diagonal
    }
  }
  return {.largest = std::max(largest[0], largest[1]), .last_cosines = !(excess[0] > 0.0 || excess[1] > 0.0)};
}

// V <- V (K + sqrt(1 + K^2)) = V (1 + K + Q/2 - Q^2/8 + ...), Q = K^2, which is orthogonal.
template <int kColumns>
VERIDYN_INLINE void turn_all(Rows<kColumns>& V, const Rows<kColumns>& K, double largest) {
  Rows<kColumns> Q, turn;
  multiply<kColumns>(K, K, 0.5, 1.0, K, turn);
  if (largest > kNoFourthPower) {
    for (std::size_t i = 0; i < kColumns; ++i) {
      Q[i] = turn[i];
      Q[i].add(-1.0, K[i]);  // Q/2
    }
    const Rows<kColumns> sum = turn;
    multiply<kColumns>(Q, Q, -0.5, 1.0, sum, turn);
  }
  const Rows<kColumns> old = V;
  multiply<kColumns>(old, turn, 1.0, 1.0, old, V);
}

// Rotates the pairs of columns of B (and V) with large angles one by one.
template <int kColumns>
VERIDYN_INLINE void turn_pairs(Rows<kColumns>& V, Rows<kColumns>& B, const Rows<kColumns>& K) {
  for (int i = 0; i < kColumns; ++i) {
    for (int j = i + 1; j < kColumns; ++j) {
      if (!(std::abs(K[i](j)) > kLargestAngle)) continue;
      double pi = 0.0, pj = 0.0, d = 0.0;  // afresh: other pairs have turned these columns
      for (const auto& b : B) {
        pi += b(i) * b(i);
        pj += b(j) * b(j);
        d += b(i) * b(j);
      }
      if (!(d * d > (kNoAngle * kNoAngle) * pi * pj)) continue;
      const double difference = pi - pj;
      const double t = 2.0 * d / (difference + std::copysign(std::hypot(difference, 2.0 * d), difference));
      const double c = 1.0 / std::sqrt(1.0 + t * t), s = c * t;
      for (std::size_t k = 0; k < kColumns; ++k) {
        const double b = B[k](i), v = V[k](i);
        B[k].set(i, c * b + s * B[k](j));
        B[k].set(j, c * B[k](j) - s * b);
        V[k].set(i, c * v + s * V[k](j));
        V[k].set(j, c * V[k](j) - s * v);
      }
    }
  }
}

/// View of the arrays that a tracked decomposition consists of.
struct Tracked {
  double* vectors;  // rows of V
  double* values;
  std::uint64_t* turns;
  std::uint64_t* updates;
};

// What a fresh row does to the decomposition before it: B'B = weight S^2 + y y', y = V' d. Turns V by that, and returns
// the largest angle; nothing where the angles are too large to turn together.
template <int kColumns>
VERIDYN_INLINE std::optional<double> turn_for_row(Rows<kColumns>& V, Rows<kColumns>& G, Rows<kColumns>& K,
                                                  const double* values, const double* fresh, double weight) {
  constexpr auto kSize = at(kColumns);
  constexpr std::size_t kPairs = Row<kColumns>::kPairs;
  Row<kColumns> y = Row<kColumns>::zero(), power = y;
  for (std::size_t i = 0; i < kSize; ++i) y.add(fresh[i], V[i]);
  for (std::size_t j = 0; j < kPairs; ++j) {
    const Pair s{values[2 * j], 2 * j + 1 < kSize ? values[2 * j + 1] : 0.0};
    power.pair[j] = weight * s * s + y.pair[j] * y.pair[j];
  }
  for (std::size_t i = 0; i < kSize; ++i) {
    const double current = y(static_cast<int>(i));
    for (std::size_t j = 0; j < kPairs; ++j) G[i].pair[j] = Pair{current, current} * y.pair[j];
  }
  const Angles angles = angles_of<kColumns>(G, power, K);
  if (!(angles.largest <= kLargestAngle)) return std::nullopt;
  turn_all<kColumns>(V, K, angles.largest);
  return angles.largest;
}

// Largest value first: the values, and with them the columns of V.
template <int kColumns>
VERIDYN_INLINE void sort_columns(double* values, Rows<kColumns>& V) {
  for (std::size_t j = 1; j < at(kColumns); ++j) {
    for (std::size_t i = j; i > 0 && values[i] > values[i - 1]; --i) {
      std::swap(values[i], values[i - 1]);
      for (auto& v : V) {
        const double swapped = v(static_cast<int>(i));
        v.set(static_cast<int>(i), v(static_cast<int>(i) - 1));
        v.set(static_cast<int>(i) - 1, swapped);
      }
    }
  }
}

template <int kColumns>
VERIDYN_INLINE void track(const Tracked& tracked, const double* triangle, int stride, const double* fresh,
                          double weight) {
  double* const vectors = tracked.vectors;
  double* const values = tracked.values;
  constexpr auto kSize = at(kColumns);
  constexpr std::size_t kPairs = Row<kColumns>::kPairs;

  Rows<kColumns> V, B, G, K;
  for (std::size_t i = 0; i < kSize; ++i) {
    for (std::size_t j = 0; j < kPairs; ++j) {
      const double* source = vectors + 2 * (i * kPairs + j);
      V[i].pair[j] = Pair{source[0], source[1]};
    }
  }
  bool clean = false;
  double largest = 0.0;
  for (int i = 0; i < kColumns; ++i) {
    for (int j = i; j < kColumns; ++j) largest = std::max(largest, std::abs(triangle[i * stride + j]));
  }
  double unit = 1.0;  // squares must neither overflow nor vanish
  if (largest > 1e100 || largest < 1e-100) {
    int exponent = 0;
    if (largest > 0.0) (void)std::frexp(largest, &exponent);
    unit = std::ldexp(1.0, std::clamp(exponent, -1000, 1000));
  } else if (fresh != nullptr) {
    if (const auto angle = turn_for_row<kColumns>(V, G, K, values, fresh, weight)) {
      ++*tracked.turns;
      clean = *angle > kCleanAngle;
    }
  }
  const double inverse_unit = 1.0 / unit;

  Row<kColumns> power = Row<kColumns>::zero();
  for (int count = 0;; ++count) {
    for (std::size_t i = 0; i < kSize; ++i) {
      Row<kColumns> sum = Row<kColumns>::zero();
      const double* row = triangle + static_cast<int>(i) * stride;
      for (std::size_t k = i; k < kSize; ++k) sum.add(row[k] * inverse_unit, V[k]);
      B[i] = sum;
    }
    gram<kColumns>(B, G);
    power = Row<kColumns>::zero();
    for (const auto& b : B) {
      for (std::size_t j = 0; j < kPairs; ++j) power.pair[j] += b.pair[j] * b.pair[j];
    }
    const Angles angles = angles_of<kColumns>(G, power, K);
    if (angles.largest == 0.0 || count == kMostTurns) break;
    ++*tracked.turns;
    clean = clean || angles.largest > kCleanAngle;
    if (angles.largest > kLargestAngle) {
      turn_pairs<kColumns>(V, B, K);
    } else {
      turn_all<kColumns>(V, K, angles.largest);
      if (angles.largest <= kLastAngle && angles.last_cosines) break;
    }
  }

  if (++*tracked.updates % kUpdatesPerCleaning == 0 || clean) {
    // V <- V (3 - V'V)/2: the error of orthogonality is squared.
    gram<kColumns>(V, G);
    B = V;
    multiply<kColumns>(B, G, -0.5, 1.5, B, V);
  }
  for (std::size_t i = 0; i < kSize; ++i) values[i] = power(static_cast<int>(i));
  sort_columns<kColumns>(values, V);
  for (std::size_t i = 0; i < kSize; ++i) values[i] = unit * std::sqrt(values[i]);
  for (std::size_t i = 0; i < kSize; ++i) {
    for (std::size_t j = 0; j < kPairs; ++j) {
      double* target = vectors + 2 * (i * kPairs + j);
      target[0] = V[i].pair[j][0];
      target[1] = V[i].pair[j][1];
    }
  }
}

template <int kColumns>
void track_on_any(const Tracked& tracked, const double* triangle, int stride, const double* fresh, double weight) {
  track<kColumns>(tracked, triangle, stride, fresh, weight);
}

#if VERIDYN_HAS_FAST_VERSION
template <int kColumns>
__attribute__((target("avx2,fma"))) void track_fast(const Tracked& tracked, const double* triangle, int stride,
                                                    const double* fresh, double weight) {
  track<kColumns>(tracked, triangle, stride, fresh, weight);
}
const bool kFast = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#endif

template <int kColumns>
void track_here(const Tracked& tracked, const double* triangle, int stride, const double* fresh, double weight) {
#if VERIDYN_HAS_FAST_VERSION
  if (kFast) return track_fast<kColumns>(tracked, triangle, stride, fresh, weight);
#endif
  track_on_any<kColumns>(tracked, triangle, stride, fresh, weight);
}

}  // namespace

TrackedSvd::TrackedSvd(int columns) : columns_(columns), padded_(columns + columns % 2) {
  VERIDYN_ASSERT(columns >= 1 && columns <= kMaxRecursiveColumns);
  for (int j = 0; j < columns; ++j) vectors_[j * padded_ + j] = 1.0;
}

SmallMatrix TrackedSvd::vectors() const {
  SmallMatrix V(columns_, columns_);
  for (int j = 0; j < columns_; ++j) {
    for (int i = 0; i < columns_; ++i) V(i, j) = vector(i, j);
  }
  return V;
}

void TrackedSvd::update(const double* triangle, int stride, const double* fresh, double weight) {
  const Tracked tracked{.vectors = vectors_.data(), .values = values_.data(), .turns = &turns_, .updates = &updates_};
  switch (columns_) {
    case 1:
      values_[0] = std::abs(triangle[0]);
      return;
    case 2:
      return track_here<2>(tracked, triangle, stride, fresh, weight);
    case 3:
      return track_here<3>(tracked, triangle, stride, fresh, weight);
    case 4:
      return track_here<4>(tracked, triangle, stride, fresh, weight);
    case 5:
      return track_here<5>(tracked, triangle, stride, fresh, weight);
    case 6:
      return track_here<6>(tracked, triangle, stride, fresh, weight);
    case 7:
      return track_here<7>(tracked, triangle, stride, fresh, weight);
    case 8:
      return track_here<8>(tracked, triangle, stride, fresh, weight);
    default:
      return track_here<9>(tracked, triangle, stride, fresh, weight);
  }
}

}  // namespace veridyn::estimation
