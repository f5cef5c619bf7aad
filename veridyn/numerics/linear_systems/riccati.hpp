#pragma once

#include <Eigen/Core>

namespace veridyn::numerics {

/// The control that makes a quadratic cost least.
struct LinearQuadratic {
  Eigen::MatrixXd P;      ///< x' P x is the least cost from x on
  Eigen::MatrixXd K;      ///< inputs x states: u = -K x
  double residual = 0.0;  ///< of the Riccati equation: Frobenius norm over that of its largest term
  double slowest = 0.0;   ///< largest real part of the closed loop's eigenvalues [1/s]; discrete: largest modulus
};

/// Least integral of x' Q x + 2 x' N u + u' R u of x' = A x + B u:
/// A' P + P A - (P B + N) R^-1 (B' P + N') + Q = 0, K = R^-1 (B' P + N').
///
/// By the matrix sign function of the Hamiltonian matrix (Byers 1987, Linear Algebra Appl 85:267), refined by Newton's
/// method (Kleinman 1968, IEEE Trans Autom Control 13:114).
/// @param Q states x states, symmetric @param R inputs x inputs, positive definite @param N states x inputs; empty: 0
/// @throws InputError where sizes do not fit, R is not positive definite, or no control makes the loop stable.
[[nodiscard]] LinearQuadratic linear_quadratic(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                               const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R,
                                               const Eigen::MatrixXd& N = {});

/// Least sum of x' Q x + 2 x' N u + u' R u of x(k+1) = A x(k) + B u(k):
/// P = A' P A - (A' P B + N) (R + B' P B)^-1 (B' P A + N') + Q. By the structure-preserving doubling algorithm (Chu,
/// Fan, Lin & Wang 2004, Int J Control 77:767), refined by Newton's method (Hewer 1971, IEEE Trans Autom Control
/// 16:382).
/// @throws as `linear_quadratic`.
[[nodiscard]] LinearQuadratic discrete_linear_quadratic(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                                        const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R,
                                                        const Eigen::MatrixXd& N = {});

}  // namespace veridyn::numerics
