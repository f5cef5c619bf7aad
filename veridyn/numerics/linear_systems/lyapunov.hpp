#pragma once

#include <Eigen/Core>

namespace veridyn::numerics {

/// Solution of a matrix equation and what is left of it.
struct MatrixSolution {
  Eigen::MatrixXd X;
  double residual = 0.0;  ///< Frobenius norm of what is left of the equation over that of its largest term
};

/// A X + X A' + Q = 0: the covariance of x' = A x under white noise of density Q. By the Schur form (Bartels & Stewart
/// 1972, Commun ACM 15:820).
/// @param Q symmetric @throws InputError where two eigenvalues of A add up to zero: there is no single solution.
[[nodiscard]] MatrixSolution lyapunov(const Eigen::MatrixXd& A, const Eigen::MatrixXd& Q);

/// A X A' - X + Q = 0: the covariance of x(k+1) = A x(k) under white noise of covariance Q.
/// @throws InputError where the product of two eigenvalues of A is one.
[[nodiscard]] MatrixSolution discrete_lyapunov(const Eigen::MatrixXd& A, const Eigen::MatrixXd& Q);

}  // namespace veridyn::numerics
