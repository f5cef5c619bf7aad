#pragma once

#include <Eigen/Core>
#include <array>

#include "veridyn/estimation/recursive/small_matrix.hpp"
#include "veridyn/estimation/recursive/tracked_svd.hpp"

namespace veridyn::estimation {

/// Mixed OLS-TLS, row by row: what `whiten` (total_least_squares.hpp) makes of a whole triangle, kept up to date.
///
/// With T = [T_e, T_w] of W (`error_basis`) each row d = [x, z] becomes d T, and Givens rotations keep the triangle
/// [R11, R12; 0, R22] of all of them: R11 and R12 of the exact columns and R22 of those with unit error under one
/// forgetting. Singular values and V are those of R22 (`TrackedSvd`); basis vectors are
///     b_j = T_w v_j - T_e R11^-1 R12 v_j,  h = [theta; -1] in their span,
/// so least squares (W zero but for z), GTLS and PCA-GTLS all follow. Exact columns that are dependent below 1e-12
/// leave their rows to R22, and their null space to `null_columns`. Nothing allocates after construction.
class RecursiveTotalLeastSquares {
 public:
  /// @param error_covariance W, m x m with 2 <= m <= 9, positive semi-definite, W_zz > 0 (last)
  explicit RecursiveTotalLeastSquares(const Eigen::MatrixXd& error_covariance);

  [[nodiscard]] int columns() const { return size_; }
  /// Columns with error, w.
  [[nodiscard]] int noisy_columns() const { return noisy_; }

  /// Are all values of the row, and of the row over its errors, at most 1e150 in size?
  [[nodiscard]] bool accepts(const double* row) const;
  /// Adds a row of m values after weighting the squares of those before by `weight` (0, 1].
  /// @return false, and nothing changes, when it is not accepted
  bool append(const double* row, double weight);
  /// Adds to R22 what `rows` rows of errors alone would: R22'R22 += rows I.
  void append_errors(double rows);

  [[nodiscard]] double singular_value(int j) const { return svd_.singular_value(j); }
  [[nodiscard]] const TrackedSvd& svd() const { return svd_; }
  /// b_j, m values; |D b_j| = singular value j, b_j' W b_j = 1.
  void basis(int j, double* b) const;
  /// Exact combinations of full rank r, and column i < r with |D e_i| = 1, orthogonal in the data to all b_j.
  [[nodiscard]] int exact_rank() const { return rank_; }
  void exact_basis(int i, double* e) const;
  /// Exact combinations that do not show in the data.
  [[nodiscard]] int null_columns() const { return exact_ - rank_; }
  void null_basis(int i, double* t) const;
  /// d b_j for all j < w and d e_i for all i < r, of a row d.
  void coordinates(const double* row, double* along_basis, double* along_exact) const;
  /// |R22 (whitened part of h)|^2: weighted sum of (D h)^2 for h in the span of the b_j and null columns.
  [[nodiscard]] double power(const double* h) const;
  /// Share of column m - 1 in sum |d_i h_i|^2, what the columns times h contribute: 0 where h says nothing of z.
  [[nodiscard]] double share_of_last(const double* h) const;
  /// Rows of a matrix A (`rows` of them, m or fewer) with A'A = D'D.
  void square_root(SmallMatrix& A) const;

 private:
  static constexpr int kStride = kMaxRecursiveColumns + 1;
  using Table = std::array<double, kStride * kMaxRecursiveColumns>;

  [[nodiscard]] bool whiten_row(const double* row, double* whitened) const;
  void decompose(const double* fresh, double weight);
  void split_exact();
  [[nodiscard]] const double* triangle(int i) const { return triangle_.data() + i * kStride; }
  [[nodiscard]] double* triangle(int i) { return triangle_.data() + i * kStride; }

  int size_ = 0;
  int exact_ = 0;
  int noisy_ = 0;
  int rank_ = 0;
  bool diagonal_ = false;  // T only scales and reorders columns
  unsigned appended_ = 0;
  std::array<int, kMaxRecursiveColumns> source_{};  // with `diagonal_`: row of the only element of column j
  Table T_{};                                       // T_[j * kStride + i] = T(i, j)
  Table inverse_{};                                 // inverse_[j * kStride + i] = T^-1(j, i)
  Table triangle_{};
  // Only while exact columns are dependent: exact basis in T_e coordinates, R12 in its rows, null space, R22 with the
  // rows that were left.
  Table exact_basis_{}, exact_noisy_{}, null_basis_{}, rest_{};
  std::array<double, kMaxRecursiveColumns> column_power_{};
  TrackedSvd svd_;
};

}  // namespace veridyn::estimation
