#include "veridyn/estimation/regression/augmented_qr.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/assert.hpp"

namespace veridyn::estimation {

AugmentedQr::AugmentedQr(Eigen::Index columns, Eigen::Index block_rows)
    : columns_(columns), block_rows_(block_rows), work_(Eigen::MatrixXd::Zero(columns + block_rows, columns)) {
  VERIDYN_ASSERT(columns > 0 && block_rows > 0);
}

// Householder reflections that keep the structure: below the diagonal of the triangle there are only the fresh rows, so
// a column's reflector is its diagonal element and its fresh part.
void AugmentedQr::reduce(Eigen::Index fresh_rows) {
  for (Eigen::Index j = 0; j < columns_; ++j) {
    auto v = work_.col(j).segment(columns_, fresh_rows);
    const double tail = v.squaredNorm();
    if (tail == 0.0) continue;
    const double head = work_(j, j);
    const double beta = head > 0.0 ? -std::sqrt(head * head + tail) : std::sqrt(head * head + tail);
    const double scale = head - beta;  // reflector [scale; v]
    const double tau = -scale / beta;  // of the reflector divided by scale
    work_(j, j) = beta;
    const double inverse = 1.0 / scale;
    for (Eigen::Index k = j + 1; k < columns_; ++k) {
      auto w = work_.col(k).segment(columns_, fresh_rows);
      const double product = tau * (work_(j, k) + inverse * v.dot(w));
      work_(j, k) -= product;
      w -= (product * inverse) * v;
    }
  }
}

void AugmentedQr::append(const Eigen::Ref<const RowMatrix>& rows) {
  VERIDYN_ASSERT(rows.cols() == columns_);
  for (Eigen::Index begin = 0; begin < rows.rows(); begin += block_rows_) {
    const Eigen::Index count = std::min(block_rows_, rows.rows() - begin);
    work_.middleRows(columns_, count) = rows.middleRows(begin, count);
    reduce(count);
  }
  rows_ += static_cast<double>(rows.rows());
}

void AugmentedQr::append(const Eigen::Ref<const RowMatrix>& regressors,
                         const Eigen::Ref<const Eigen::VectorXd>& regressand,
                         const Eigen::Ref<const Eigen::VectorXd>& scale) {
  VERIDYN_ASSERT(regressors.cols() + 1 == columns_ && regressors.rows() == regressand.size());
  for (Eigen::Index begin = 0; begin < regressors.rows(); begin += block_rows_) {
    const Eigen::Index count = std::min(block_rows_, regressors.rows() - begin);
    auto fresh = work_.middleRows(columns_, count);
    fresh.leftCols(columns_ - 1) = regressors.middleRows(begin, count);
    fresh.col(columns_ - 1) = regressand.segment(begin, count);
    if (scale.size() > 0) {
      for (Eigen::Index k = 0; k < count; ++k) fresh.row(k) /= scale(begin + k);
    }
    reduce(count);
  }
  rows_ += static_cast<double>(regressors.rows());
}

void AugmentedQr::scale(double factor) {
  work_.topRows(columns_) *= factor;
  rows_ *= factor * factor;
}

Eigen::MatrixXd AugmentedQr::triangle() const { return work_.topRows(columns_).triangularView<Eigen::Upper>(); }

Eigen::MatrixXd triangle_of(const RegressionData& data) {
  AugmentedQr qr(data.parameters() + 1);
  qr.append(data.regressors, data.regressand, data.row_scale);
  return qr.triangle();
}

Eigen::MatrixXd retriangulate(const Eigen::MatrixXd& matrix) {
  AugmentedQr qr(matrix.cols(), matrix.rows());
  qr.append(RowMatrix(matrix));
  return qr.triangle();
}

}  // namespace veridyn::estimation
