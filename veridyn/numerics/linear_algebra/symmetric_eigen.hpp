#pragma once

#include <Eigen/Core>

namespace veridyn::numerics {

/// A = V diag(values) V' of a symmetric matrix: values ascending, vectors orthonormal columns.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

/// A = V diag(values) V^H of a Hermitian matrix: values real and ascending, vectors unitary.
struct HermitianEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXcd vectors;
};

/// Eigenvalues and vectors of a symmetric matrix by tridiagonalisation and implicit QR (Golub & Van Loan, Matrix
/// Computations, 8.3). Reads the lower triangle. A matrix of no rows has no eigenvalues.
[[nodiscard]] SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix);

/// Eigenvalues alone, ascending: cheaper.
[[nodiscard]] Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix);

/// As `symmetric_eigen` for a Hermitian matrix.
[[nodiscard]] HermitianEigen hermitian_eigen(const Eigen::MatrixXcd& matrix);

/// V diag(values) V': a symmetric matrix put together again, with other eigenvalues where the caller changed them.
[[nodiscard]] Eigen::MatrixXd from_eigen(const Eigen::MatrixXd& vectors, const Eigen::VectorXd& values);
/// V diag(values) V^H.
[[nodiscard]] Eigen::MatrixXcd from_eigen(const Eigen::MatrixXcd& vectors, const Eigen::VectorXd& values);

}  // namespace veridyn::numerics
