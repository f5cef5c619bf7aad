#pragma once

#include <Eigen/Core>

#include "veridyn/estimation/regression/regression_data.hpp"

namespace veridyn::estimation {

/// Triangle R of the QR factorisation of an augmented matrix D = [X, z], built from blocks of rows in one pass.
///
/// R'R = D'D without ever forming D'D, so OLS, TLS, their singular values and condition numbers come from the (n+1) x
/// (n+1) triangle with the digits of a QR of the whole. Memory is one block; Householder reflections are blocked, so
/// cost is one read of the data and 2 N (n+1)^2 operations. A block is stacked below the triangle of the blocks before;
/// nothing is allocated after construction except when a larger block than `block_rows` is handed over (it is cut up
/// instead). To start from earlier knowledge (a batch estimate as rows, a forgotten triangle) append its rows or
/// `scale` the triangle.
class AugmentedQr {
 public:
  /// @param columns n + 1, the regressand included
  explicit AugmentedQr(Eigen::Index columns, Eigen::Index block_rows = 512);

  /// Appends rows of D; `scale` (empty or one a row) divides them.
  void append(const Eigen::Ref<const RowMatrix>& rows);
  void append(const Eigen::Ref<const RowMatrix>& regressors, const Eigen::Ref<const Eigen::VectorXd>& regressand,
              const Eigen::Ref<const Eigen::VectorXd>& scale);
  /// Multiplies the triangle by `factor`, and the number of rows by its square: forgetting.
  void scale(double factor);

  /// Upper triangular, (n+1) x (n+1); signs of the diagonal are not fixed.
  [[nodiscard]] Eigen::MatrixXd triangle() const;
  /// Rows appended (weighted by forgetting).
  [[nodiscard]] double rows() const { return rows_; }
  [[nodiscard]] Eigen::Index columns() const { return columns_; }

 private:
  void reduce(Eigen::Index fresh_rows);

  Eigen::Index columns_;
  Eigen::Index block_rows_;
  double rows_ = 0.0;
  Eigen::MatrixXd work_;  // triangle on top, fresh rows below
};

/// Triangle of the data with its rows scaled, in the order of [regressors, regressand].
[[nodiscard]] Eigen::MatrixXd triangle_of(const RegressionData& data);

/// Triangle of R T for a small matrix T (columns recombined): the QR of D T without reading D again.
[[nodiscard]] Eigen::MatrixXd retriangulate(const Eigen::MatrixXd& matrix);

}  // namespace veridyn::estimation
