#include "veridyn/estimation/tracked_svd.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "veridyn/core/assert.hpp"

namespace veridyn::estimation {
namespace {

// Angles below this are turned at once and not looked at again; what is left is their square.
constexpr double kLastAngle = 1e-6;
// Above this a turn of all columns at once would not be orthogonal to rounding (its error is angle^6/8).
constexpr double kLargestAngle = 0.01;
// Below this it is so without the fourth power.
constexpr double kNoFourthPower = 1e-4;
// Cosines below this are rounding.
constexpr double kNoAngle = 4.0 * std::numeric_limits<double>::epsilon();
constexpr int kMostTurns = 60;
constexpr std::uint64_t kUpdatesPerCleaning = 64;

// Two doubles at a time (every x86-64 and ARMv8 has them): rows below are kept in registers while they are summed.
using Pair = double __attribute__((vector_size(16)));

template <int kColumns>
struct Row {
  static constexpr int kPairs = (kColumns + 1) / 2;
  Pair pair[kPairs];

  static Row zero() {
    Row r;
    for (Pair& p : r.pair) p = Pair{0.0, 0.0};
    return r;
  }
  void add(double a, const Row& x) {
    const Pair factor{a, a};
    for (int j = 0; j < kPairs; ++j) pair[j] += factor * x.pair[j];
  }
  void scale(double a) {
    const Pair factor{a, a};
    for (Pair& p : pair) p *= factor;
  }
  double operator()(int j) const { return pair[j / 2][j % 2]; }
  /// Slow: a pair must not be read soon after one of its halves was written.
  void set(int j, double value) { pair[j / 2][j % 2] = value; }
};

template <int kColumns>
using Rows = std::array<Row<kColumns>, static_cast<std::size_t>(kColumns)>;

// a' b of the rows of two square matrices, the Gram matrix when they are the same.
template <int kColumns>
void gram(const Rows<kColumns>& b, Rows<kColumns>& result) {
  for (std::size_t i = 0; i < kColumns; ++i) {
    Row<kColumns> sum = Row<kColumns>::zero();
    for (std::size_t k = 0; k < kColumns; ++k) sum.add(b[k](static_cast<int>(i)), b[k]);
    result[i] = sum;
  }
}

// y_i = scale x_i + factor sum_k a_ik b_k
template <int kColumns>
void multiply(const Rows<kColumns>& a, const Rows<kColumns>& b, double factor, double scale, const Rows<kColumns>& x,
              Rows<kColumns>& y) {
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
  double largest = 0.0;       ///< infinite for columns of equal length that are not orthogonal
  bool last_cosines = true;  ///< all cosines below kLastAngle
};

// K_ij = g_ij/(g_jj - g_ii), 0 where the columns are orthogonal to rounding.
template <int kColumns>
Angles angles_of(const Rows<kColumns>& G, const Row<kColumns>& power, Rows<kColumns>& K) {
  constexpr int kPairs = Row<kColumns>::kPairs;
  const Pair none{0.0, 0.0};
  Pair largest = none, excess = none;
  for (std::size_t i = 0; i < kColumns; ++i) {
    const Pair own{power(static_cast<int>(i)), power(static_cast<int>(i))};
    for (int j = 0; j < kPairs; ++j) {
      const Pair d = G[i].pair[j];
      const Pair product = own * power.pair[j];
      const Pair square = d * d;
      Pair difference = power.pair[j] - own;
      if (j == static_cast<int>(i) / 2) difference[static_cast<int>(i) % 2] = std::numeric_limits<double>::infinity();
      Pair k = d / difference;
      k = square > (kNoAngle * kNoAngle) * product ? k : none;
      K[i].pair[j] = k;
      const Pair size = k < none ? -k : k;
      largest = size > largest ? size : largest;
      const Pair over = square - (kLastAngle * kLastAngle) * product;
      if (j != static_cast<int>(i) / 2) {
        excess = over > excess ? over : excess;
      } else {
        const int other = 1 - static_cast<int>(i) % 2;
        if (over[other] > excess[other]) excess[other] = over[other];
      }
    }
  }
  return {.largest = std::max(largest[0], largest[1]), .last_cosines = !(excess[0] > 0.0 || excess[1] > 0.0)};
}

// V <- V (K + sqrt(1 + K^2)) = V (1 + K + Q/2 - Q^2/8 + ...), Q = K^2, which is orthogonal.
template <int kColumns>
void turn_all(Rows<kColumns>& V, const Rows<kColumns>& K, double largest) {
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
void turn_pairs(Rows<kColumns>& V, Rows<kColumns>& B, const Rows<kColumns>& K) {
  for (int i = 0; i < kColumns; ++i) {
    for (int j = i + 1; j < kColumns; ++j) {
      if (!(std::abs(K[static_cast<std::size_t>(i)](j)) > kLargestAngle)) continue;
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

}  // namespace

TrackedSvd::TrackedSvd(int columns) : columns_(columns), padded_(columns + columns % 2) {
  VERIDYN_ASSERT(columns >= 1 && columns <= kMaxRecursiveColumns);
  for (int j = 0; j < columns; ++j) vectors_[static_cast<std::size_t>(j * padded_ + j)] = 1.0;
}

SmallMatrix TrackedSvd::vectors() const {
  SmallMatrix V(columns_, columns_);
  for (int j = 0; j < columns_; ++j) {
    for (int i = 0; i < columns_; ++i) V(i, j) = vector(i, j);
  }
  return V;
}

template <int kColumns>
void TrackedSvd::decompose(const double* triangle, int stride, const double* fresh, double weight) {
  constexpr auto kSize = static_cast<std::size_t>(kColumns);
  constexpr std::size_t kPairs = Row<kColumns>::kPairs;

  Rows<kColumns> V, B, G, K;
  for (std::size_t i = 0; i < kSize; ++i) {
    for (std::size_t j = 0; j < kPairs; ++j) {
      const double* source = vectors_.data() + 2 * (i * kPairs + j);
      V[i].pair[j] = Pair{source[0], source[1]};
    }
  }
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
    // What the fresh row does to the decomposition before it: B'B = weight S^2 + y y', y = V' d.
    Row<kColumns> y = Row<kColumns>::zero(), power = y;
    for (std::size_t i = 0; i < kSize; ++i) y.add(fresh[i], V[i]);
    for (std::size_t j = 0; j < kPairs; ++j) {
      const Pair s{values_[2 * j], 2 * j + 1 < kSize ? values_[2 * j + 1] : 0.0};
      power.pair[j] = weight * s * s + y.pair[j] * y.pair[j];
    }
    for (std::size_t i = 0; i < kSize; ++i) {
      const double own = y(static_cast<int>(i));
      for (std::size_t j = 0; j < kPairs; ++j) G[i].pair[j] = Pair{own, own} * y.pair[j];
    }
    const Angles angles = angles_of<kColumns>(G, power, K);
    if (angles.largest <= kLargestAngle) {
      turn_all<kColumns>(V, K, angles.largest);
      ++turns_;
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
    ++turns_;
    if (angles.largest > kLargestAngle) {
      turn_pairs<kColumns>(V, B, K);
    } else {
      turn_all<kColumns>(V, K, angles.largest);
      if (angles.largest <= kLastAngle && angles.last_cosines) break;
    }
  }

  if (++updates_ % kUpdatesPerCleaning == 0) {
    // V <- V (3 - V'V)/2: the error of orthogonality is squared.
    gram<kColumns>(V, G);
    B = V;
    multiply<kColumns>(B, G, -0.5, 1.5, B, V);
  }
  for (std::size_t i = 0; i < kSize; ++i) values_[i] = power(static_cast<int>(i));
  for (std::size_t j = 1; j < kSize; ++j) {
    for (std::size_t i = j; i > 0 && values_[i] > values_[i - 1]; --i) {
      std::swap(values_[i], values_[i - 1]);
      for (auto& v : V) {
        const double swapped = v(static_cast<int>(i));
        v.set(static_cast<int>(i), v(static_cast<int>(i) - 1));
        v.set(static_cast<int>(i) - 1, swapped);
      }
    }
  }
  for (std::size_t i = 0; i < kSize; ++i) values_[i] = unit * std::sqrt(values_[i]);
  for (std::size_t i = 0; i < kSize; ++i) {
    for (std::size_t j = 0; j < kPairs; ++j) {
      double* target = vectors_.data() + 2 * (i * kPairs + j);
      target[0] = V[i].pair[j][0];
      target[1] = V[i].pair[j][1];
    }
  }
}

void TrackedSvd::update(const double* triangle, int stride, const double* fresh, double weight) {
  switch (columns_) {
    case 1:
      values_[0] = std::abs(triangle[0]);
      return;
    case 2:
      return decompose<2>(triangle, stride, fresh, weight);
    case 3:
      return decompose<3>(triangle, stride, fresh, weight);
    case 4:
      return decompose<4>(triangle, stride, fresh, weight);
    case 5:
      return decompose<5>(triangle, stride, fresh, weight);
    case 6:
      return decompose<6>(triangle, stride, fresh, weight);
    case 7:
      return decompose<7>(triangle, stride, fresh, weight);
    case 8:
      return decompose<8>(triangle, stride, fresh, weight);
    default:
      return decompose<9>(triangle, stride, fresh, weight);
  }
}

}  // namespace veridyn::estimation
