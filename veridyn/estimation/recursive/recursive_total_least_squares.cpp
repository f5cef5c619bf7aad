#include "veridyn/estimation/recursive/recursive_total_least_squares.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "veridyn/core/assert.hpp"
#include "veridyn/estimation/regression/total_least_squares.hpp"

namespace veridyn::estimation {
namespace {

constexpr double kLargestEntry = 1e150;
constexpr double kDependentColumns = 1e-12;
// Forgotten values below this become zero before they become slow (subnormal) numbers.
constexpr double kForgotten = 1e-280;
constexpr unsigned kAppendsPerSweep = 16;

double length_of(double a, double b) {
  const double square = a * a + b * b;
  return square > 1e-280 && square < 1e300 ? std::sqrt(square) : std::hypot(a, b);
}

// Rotates a row into rows begin..end of the triangle, which are weighted by `root` before; what is left of it is in
// `row` from `end` on.
void rotate_in(double* table, int stride, int begin, int end, int columns, double* row, double root) {
  for (int j = begin; j < end; ++j) {
    double* r = table + j * stride;
    const double a = root * r[j], b = row[j];
    const double length = length_of(a, b);
    if (length == 0.0) {  // zero diagonal: the rest of the row is still forgotten
      for (int k = j; k < columns; ++k) r[k] *= root;
      continue;
    }
    const double c = a / length, s = b / length;
    const double c_root = c * root, s_root = s * root;
    r[j] = length;
    for (int k = j + 1; k < columns; ++k) {
      const double old = r[k], fresh = row[k];
      r[k] = c_root * old + s * fresh;
      row[k] = c * fresh - s_root * old;
    }
  }
}

}  // namespace

RecursiveTotalLeastSquares::RecursiveTotalLeastSquares(const Eigen::MatrixXd& W) : svd_(1) {
  VERIDYN_ASSERT(W.rows() == W.cols() && W.rows() >= 2 && W.rows() <= kMaxRecursiveColumns);
  const ErrorBasis errors = error_basis(W);
  size_ = static_cast<int>(W.rows());
  exact_ = static_cast<int>(errors.exact.cols());
  noisy_ = static_cast<int>(errors.white.cols());
  VERIDYN_ASSERT(exact_ + noisy_ == size_ && noisy_ > 0);
  Eigen::MatrixXd T(size_, size_);
  T << errors.exact, errors.white;
  const Eigen::MatrixXd inverse = T.inverse();
  diagonal_ = true;
  for (int j = 0; j < size_; ++j) {
    int elements = 0;
    for (int i = 0; i < size_; ++i) {
      T_[j * kStride + i] = T(i, j);
      inverse_[j * kStride + i] = inverse(j, i);
      if (T(i, j) != 0.0) {
        ++elements;
        source_[j] = i;
      }
    }
    diagonal_ = diagonal_ && elements == 1;
  }
  svd_ = TrackedSvd(noisy_);
  split_exact();
}

bool RecursiveTotalLeastSquares::whiten_row(const double* row, double* y) const {
  bool good = true;
  for (int j = 0; j < size_; ++j) {
    const double* t = T_.data() + j * kStride;
    double value = 0.0;
    if (diagonal_) {
      const int i = source_[j];
      value = row[i] * t[i];
    } else {
      for (int i = 0; i < size_; ++i) value += row[i] * t[i];
    }
    y[j] = value;
    good = good && std::abs(value) <= kLargestEntry && std::abs(row[j]) <= kLargestEntry;
  }
  return good;
}

bool RecursiveTotalLeastSquares::accepts(const double* row) const {
  std::array<double, kMaxRecursiveColumns> y;
  return whiten_row(row, y.data());
}

bool RecursiveTotalLeastSquares::append(const double* row, double weight) {
  std::array<double, kMaxRecursiveColumns> y, rotated;
  if (!whiten_row(row, y.data())) return false;
  for (int i = 0; i < size_; ++i) {
    double& power = column_power_[i];
    power = weight * power + row[i] * row[i];
  }
  const double root = std::sqrt(weight);
  rotate_in(triangle_.data(), kStride, 0, exact_, size_, y.data(), root);
  rotated = y;
  rotate_in(triangle_.data(), kStride, exact_, size_, size_, rotated.data(), root);
  if (++appended_ % kAppendsPerSweep == 0) {
    for (double& r : triangle_) r = std::abs(r) < kForgotten ? 0.0 : r;
    for (double& p : column_power_) p = p < kForgotten ? 0.0 : p;
  }
  decompose(y.data() + exact_, weight);  // what the exact columns left of the row
  return true;
}

void RecursiveTotalLeastSquares::append_errors(double rows) {
  const double root = std::sqrt(rows);
  std::array<double, kMaxRecursiveColumns> row;
  for (int j = 0; j < noisy_; ++j) {
    row.fill(0.0);
    row[exact_ + j] = root;
    rotate_in(triangle_.data(), kStride, 0, size_, size_, row.data(), 1.0);
  }
  for (int i = 0; i < size_; ++i) {  // W = sum of (T^-1)' rows of the white part
    for (int j = exact_; j < size_; ++j) {
      const double t = inverse_[j * kStride + i];
      column_power_[i] += rows * t * t;
    }
  }
  decompose(nullptr, 1.0);
}

void RecursiveTotalLeastSquares::decompose(const double* fresh, double weight) {
  bool independent = true;
  for (int j = 0; j < exact_ && independent; ++j) {
    double largest = 0.0;
    for (int i = 0; i <= j; ++i) largest = std::max(largest, std::abs(triangle(i)[j]));
    independent = std::abs(triangle(j)[j]) > kDependentColumns * largest;
  }
  if (independent) {
    rank_ = exact_;
    svd_.update(triangle(exact_) + exact_, kStride, fresh, weight);
  } else {
    split_exact();
    svd_.update(rest_.data(), kStride);
  }
}

// Exact columns that are dependent: R11 L = U S V' with columns of unit length; rank r keeps U_r' [R11, R12], the other
// rows of U' R12 have nothing exact in them and go to R22.
void RecursiveTotalLeastSquares::split_exact() {
  rank_ = exact_;
  for (int i = 0; i < noisy_; ++i) {
    for (int j = 0; j < noisy_; ++j) rest_[i * kStride + j] = j < i ? 0.0 : triangle(exact_ + i)[exact_ + j];
  }
  if (exact_ == 0) return;
  SmallMatrix R11 = SmallMatrix::Zero(exact_, exact_);
  SmallVector inverse_length(exact_);
  for (int j = 0; j < exact_; ++j) {
    for (int i = 0; i <= j; ++i) R11(i, j) = triangle(i)[j];
    const double length = R11.col(j).stableNorm();
    inverse_length(j) = length > 0.0 ? 1.0 / length : 1.0;
    R11.col(j) *= inverse_length(j);
  }
  const Eigen::JacobiSVD<SmallMatrix> svd(R11, Eigen::ComputeFullU | Eigen::ComputeFullV);
  rank_ = 0;
  while (rank_ < exact_ && svd.singularValues()(rank_) > kDependentColumns * svd.singularValues()(0)) ++rank_;
  for (int i = 0; i < exact_; ++i) {
    for (int j = 0; j < exact_; ++j) {
      const double v = inverse_length(i) * svd.matrixV()(i, j);
      if (j < rank_) {
        exact_basis_[j * kStride + i] = v / svd.singularValues()(j);
      } else {
        null_basis_[(j - rank_) * kStride + i] = v;
      }
    }
  }
  for (int j = 0; j < exact_; ++j) {
    std::array<double, kMaxRecursiveColumns> row{};
    for (int k = 0; k < noisy_; ++k) {
      for (int i = 0; i < exact_; ++i) row[k] += svd.matrixU()(i, j) * triangle(i)[exact_ + k];
    }
    if (j < rank_) {
      for (int k = 0; k < noisy_; ++k) exact_noisy_[j * kStride + k] = row[k];
    } else {
      rotate_in(rest_.data(), kStride, 0, noisy_, noisy_, row.data(), 1.0);
    }
  }
}

void RecursiveTotalLeastSquares::basis(int j, double* b) const {
  std::array<double, kMaxRecursiveColumns> g;  // in T coordinates
  for (int i = 0; i < noisy_; ++i) g[exact_ + i] = svd_.vector(i, j);
  if (rank_ == exact_) {
    for (int i = exact_ - 1; i >= 0; --i) {
      double value = 0.0;
      for (int k = i + 1; k < size_; ++k) value -= triangle(i)[k] * g[k];
      g[i] = value / triangle(i)[i];
    }
  } else {
    for (int i = 0; i < exact_; ++i) g[i] = 0.0;
    for (int r = 0; r < rank_; ++r) {
      double value = 0.0;
      for (int k = 0; k < noisy_; ++k) value += exact_noisy_[r * kStride + k] * svd_.vector(k, j);
      for (int i = 0; i < exact_; ++i) g[i] -= exact_basis_[r * kStride + i] * value;
    }
  }
  if (diagonal_) {
    for (int k = 0; k < size_; ++k) {
      const int i = source_[k];
      b[i] = T_[k * kStride + i] * g[k];
    }
    return;
  }
  for (int i = 0; i < size_; ++i) b[i] = 0.0;
  for (int k = 0; k < size_; ++k) {
    for (int i = 0; i < size_; ++i) b[i] += T_[k * kStride + i] * g[k];
  }
}

void RecursiveTotalLeastSquares::exact_basis(int column, double* e) const {
  std::array<double, kMaxRecursiveColumns> g{};
  if (rank_ == exact_) {  // column of R11^-1
    g[column] = 1.0 / triangle(column)[column];
    for (int i = column - 1; i >= 0; --i) {
      double value = 0.0;
      for (int k = i + 1; k <= column; ++k) value -= triangle(i)[k] * g[k];
      g[i] = value / triangle(i)[i];
    }
  } else {
    for (int i = 0; i < exact_; ++i) g[i] = exact_basis_[column * kStride + i];
  }
  for (int i = 0; i < size_; ++i) e[i] = 0.0;
  for (int k = 0; k < exact_; ++k) {
    for (int i = 0; i < size_; ++i) e[i] += T_[k * kStride + i] * g[k];
  }
}

void RecursiveTotalLeastSquares::null_basis(int column, double* t) const {
  for (int i = 0; i < size_; ++i) t[i] = 0.0;
  for (int k = 0; k < exact_; ++k) {
    const double g = null_basis_[column * kStride + k];
    for (int i = 0; i < size_; ++i) t[i] += T_[k * kStride + i] * g;
  }
}

void RecursiveTotalLeastSquares::coordinates(const double* row, double* along_basis, double* along_exact) const {
  std::array<double, kMaxRecursiveColumns> y;
  (void)whiten_row(row, y.data());
  if (rank_ == exact_) {
    for (int i = 0; i < exact_; ++i) {  // forward substitution that carries the white part along
      const double f = y[i] / triangle(i)[i];
      along_exact[i] = f;
      for (int k = i + 1; k < size_; ++k) y[k] -= f * triangle(i)[k];
    }
  } else {
    for (int r = 0; r < rank_; ++r) {
      double f = 0.0;
      for (int i = 0; i < exact_; ++i) f += exact_basis_[r * kStride + i] * y[i];
      along_exact[r] = f;
      for (int k = 0; k < noisy_; ++k) y[exact_ + k] -= f * exact_noisy_[r * kStride + k];
    }
  }
  for (int j = 0; j < noisy_; ++j) along_basis[j] = 0.0;
  for (int i = 0; i < noisy_; ++i) {
    const double value = y[exact_ + i];
    for (int j = 0; j < noisy_; ++j) along_basis[j] += value * svd_.vector(i, j);
  }
}

double RecursiveTotalLeastSquares::power(const double* h) const {
  std::array<double, kMaxRecursiveColumns> g;
  for (int j = 0; j < noisy_; ++j) {
    const double* t = inverse_.data() + (exact_ + j) * kStride;
    double value = 0.0;
    for (int i = 0; i < size_; ++i) value += t[i] * h[i];
    g[j] = value;
  }
  double sum = 0.0;
  for (int i = 0; i < noisy_; ++i) {
    const double* r = rank_ == exact_ ? triangle(exact_ + i) + exact_ : rest_.data() + i * kStride;
    double value = 0.0;
    for (int j = i; j < noisy_; ++j) value += r[j] * g[j];
    sum += value * value;
  }
  return sum;
}

double RecursiveTotalLeastSquares::share_of_last(const double* h) const {
  double sum = 0.0, last = 0.0;
  for (int i = 0; i < size_; ++i) {
    last = column_power_[i] * h[i] * h[i];
    sum += last;
  }
  return sum > 0.0 ? last / sum : 0.0;
}

void RecursiveTotalLeastSquares::square_root(SmallMatrix& A) const {
  A.setZero(size_, size_);
  for (int i = 0; i < size_; ++i) {
    for (int k = i; k < size_; ++k) {
      for (int j = 0; j < size_; ++j) A(i, j) += triangle(i)[k] * inverse_[k * kStride + j];
    }
  }
}

}  // namespace veridyn::estimation
