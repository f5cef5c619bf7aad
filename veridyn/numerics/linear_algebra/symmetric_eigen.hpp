#pragma once

#include <Eigen/Core>

namespace veridyn::numerics {

/// A = V diag(values) V' of a symmetric matrix: values ascending, vectors orthonormal columns.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

/// Eigenvalues and vectors of a symmetric matrix by tridiagonalisation and implicit QR (Golub & Van Loan, Matrix
/// Computations, 8.3). Reads the lower triangle. A matrix of no rows has no eigenvalues.
[[nodiscard]] SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix);

/// Eigenvalues alone, ascending: cheaper.
[[nodiscard]] Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix);

/// V diag(values) V': a symmetric matrix put together again, with other eigenvalues where the caller changed them.
[[nodiscard]] Eigen::MatrixXd from_eigen(const Eigen::MatrixXd& vectors, const Eigen::VectorXd& values);

}  // namespace veridyn::numerics
