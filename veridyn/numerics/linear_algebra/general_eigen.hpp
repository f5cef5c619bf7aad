#pragma once

#include <Eigen/Core>

namespace veridyn::numerics {

/// Eigenvalues of a real square matrix and their right eigenvectors (unit length), in no particular order; complex ones
/// come in conjugate pairs.
struct GeneralEigen {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;
};

/// By Hessenberg reduction and the real QR algorithm (Golub & Van Loan, Matrix Computations, 7.5). Stability and modes
/// of x' = A x.
[[nodiscard]] GeneralEigen general_eigen(const Eigen::MatrixXd& matrix);

/// Eigenvalues alone.
[[nodiscard]] Eigen::VectorXcd general_eigenvalues(const Eigen::MatrixXd& matrix);

/// A = U T U' with U orthogonal and T upper triangular but for blocks of two rows on its diagonal, one for each pair of
/// complex eigenvalues; where there is no such pair the element below the diagonal is exactly zero.
struct RealSchur {
  Eigen::MatrixXd T;
  Eigen::MatrixXd U;
};

/// The real Schur form, by the same iteration.
[[nodiscard]] RealSchur real_schur(const Eigen::MatrixXd& matrix);

}  // namespace veridyn::numerics
