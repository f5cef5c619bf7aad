#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "veridyn/estimation/recursive/small_matrix.hpp"

namespace veridyn::estimation {

/// Singular values and right singular vectors of a small triangle that changes a little at a time.
///
/// The triangle (which its owner updates by Givens rotations) holds the data; V is only where the next decomposition
/// starts. So rounding errors of V never get into the data, however many updates there are. Each update forms B = R V,
/// whose columns are nearly orthogonal already, and turns them all at once by K + sqrt(1 + K^2), K the skew matrix of
/// the angles b_i.b_j/(|b_i|^2 - |b_j|^2), which leaves their square; pairs with an angle above 0.01 (columns of equal
/// length, a first decomposition) are turned one by one (Hestenes 1958). Once angles and cosines are below 1e-6 one
/// more such turn ends it: what is left is of order 1e-12. V is made orthonormal again every 64 updates, and after
/// angles above 1e-3 (one Newton-Schulz step). Backward stable: errors of singular values are of the order of rounding
/// of the largest. The triangle may be of any size from 1e-290 to 1e290, singular or zero.
class TrackedSvd {
 public:
  /// @param columns 1 to 9; starts with V = I
  explicit TrackedSvd(int columns);

  /// Decomposes the upper triangle whose element (i, j) is triangle[i * stride + j] (finite). Does not allocate.
  /// @param fresh the row that came since the update before, null if that is not what happened: saves a third of time
  /// @param weight of squares of the rows before it
  void update(const double* triangle, int stride, const double* fresh = nullptr, double weight = 1.0);

  [[nodiscard]] int columns() const { return columns_; }
  /// Descending.
  [[nodiscard]] double singular_value(int j) const { return values_[j]; }
  /// Element i of right singular vector j.
  [[nodiscard]] double vector(int i, int j) const { return vectors_[i * padded_ + j]; }
  [[nodiscard]] SmallMatrix vectors() const;
  /// Turns (of all columns at once, or of single pairs) so far.
  [[nodiscard]] std::uint64_t turns() const { return turns_; }

 private:
  int columns_;
  int padded_;  // length of a row of V: even, for pairs of doubles
  std::uint64_t turns_ = 0;
  std::uint64_t updates_ = 0;
  std::array<double, kMaxRecursiveColumns> values_{};
  alignas(16) std::array<double, (kMaxRecursiveColumns + 1) * kMaxRecursiveColumns> vectors_{};
};

}  // namespace veridyn::estimation
