#include "veridyn/numerics/linear_systems/lyapunov.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <complex>

#include "veridyn/core/error.hpp"

namespace veridyn::numerics {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

void check_sizes(const MatrixXd& A, const MatrixXd& Q) {
  if (A.rows() != A.cols() || Q.rows() != A.rows() || Q.cols() != A.cols())
    throw InputError("Lyapunov equation", "A and Q must be square and of one size");
  if (!A.allFinite() || !Q.allFinite()) throw InputError("Lyapunov equation", "has an entry that is not finite");
}

/// The eigenvalues of `matrix` are far enough from zero to divide by.
void check_regular(const MatrixXcd& matrix, double size) {
  constexpr double kRounding = 1e-14;
  for (const Complex d : matrix.diagonal())
    if (!(std::abs(d) > kRounding * size))
      throw InputError("Lyapunov equation", "has no single solution: A has eigenvalues that cancel each other");
}

/// In the basis in which A is upper triangular, T = U' A U, the columns of Y follow from the last to the first:
/// (alpha T + ...) y_j = right side. `column(Y, j)` says what later columns add to the right side, `shift(j)` gives the
/// triangular matrix of column j.
template <typename RightSide, typename Matrix>
MatrixXd solved(const Eigen::ComplexSchur<MatrixXd>& schur, const MatrixXd& Q, double size, const RightSide& right,
                const Matrix& matrix) {
  const MatrixXcd& U = schur.matrixU();
  const MatrixXcd Qt = U.adjoint() * Q * U;
  const Index n = Q.rows();
  MatrixXcd Y = MatrixXcd::Zero(n, n);
  for (Index j = n - 1; j >= 0; --j) {
    const MatrixXcd M = matrix(j);
    check_regular(M, size);
    Y.col(j) = M.triangularView<Eigen::Upper>().solve(-Qt.col(j) - right(Y, j));
  }
  const MatrixXd X = (U * Y * U.adjoint()).real();
  return 0.5 * (X + X.transpose());
}

double share(const MatrixXd& left, std::initializer_list<double> terms) {
  const double largest = std::max(terms);
  return largest > 0.0 ? left.norm() / largest : 0.0;
}

}  // namespace

MatrixSolution lyapunov(const MatrixXd& A, const MatrixXd& Q) {
  check_sizes(A, Q);
  const Eigen::ComplexSchur<MatrixXd> schur(A);
  const MatrixXcd& T = schur.matrixT();
  const Index n = A.rows();
  // T Y + Y T' + Q = 0, T' lower triangular: column j of Y T' is sum_{k >= j} y_k conj(T_jk).
  const auto right = [&](const MatrixXcd& Y, Index j) -> Eigen::VectorXcd {
    return Y.rightCols(n - 1 - j) * T.row(j).tail(n - 1 - j).adjoint();
  };
  const auto matrix = [&](Index j) -> MatrixXcd { return T + std::conj(T(j, j)) * MatrixXcd::Identity(n, n); };
  MatrixSolution s;
  s.X = solved(schur, Q, T.norm(), right, matrix);
  const MatrixXd AX = A * s.X;
  s.residual = share(AX + AX.transpose() + Q, {AX.norm(), Q.norm()});
  return s;
}

MatrixSolution discrete_lyapunov(const MatrixXd& A, const MatrixXd& Q) {
  check_sizes(A, Q);
  const Eigen::ComplexSchur<MatrixXd> schur(A);
  const MatrixXcd& T = schur.matrixT();
  const Index n = A.rows();
  const auto right = [&](const MatrixXcd& Y, Index j) -> Eigen::VectorXcd {
    return T * (Y.rightCols(n - 1 - j) * T.row(j).tail(n - 1 - j).adjoint());
  };
  const auto matrix = [&](Index j) -> MatrixXcd { return std::conj(T(j, j)) * T - MatrixXcd::Identity(n, n); };
  MatrixSolution s;
  s.X = solved(schur, Q, 1.0, right, matrix);
  const MatrixXd AXA = A * s.X * A.transpose();
  s.residual = share(AXA - s.X + Q, {AXA.norm(), s.X.norm(), Q.norm()});
  return s;
}

}  // namespace veridyn::numerics
