#include "veridyn/numerics/linear_systems/lyapunov.hpp"

#include <algorithm>
#include <complex>

#include "veridyn/core/error.hpp"
#include "veridyn/numerics/linear_algebra/general_eigen.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"

namespace veridyn::numerics {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// A X + X A' + Q = 0, or A X A' - X + Q = 0.
enum class LyapunovKind { kContinuous, kDiscrete };

void check_sizes(const MatrixXd& A, const MatrixXd& Q) {
  if (A.rows() != A.cols() || Q.rows() != A.rows() || Q.cols() != A.cols())
    throw InputError("Lyapunov equation", "A and Q must be square and of one size");
  if (!A.allFinite() || !Q.allFinite()) throw InputError("Lyapunov equation", "has an entry that is not finite");
}

/// The equation's own eigenvalues, l_i + l_j or l_i l_j - 1 of those of A, are far enough from zero to divide by.
void check_regular(const MatrixXd& A, LyapunovKind kind) {
  constexpr double kRounding = 1e-14;
  const bool continuous = kind == LyapunovKind::kContinuous;
  const double least = kRounding * (continuous ? A.norm() : 1.0);
  const Eigen::VectorXcd values = general_eigenvalues(A);
  for (const std::complex<double> a : values)
    for (const std::complex<double> b : values)
      if (!(std::abs(continuous ? a + b : a * b - 1.0) > least))
        throw InputError("Lyapunov equation", "has no single solution: A has eigenvalues that cancel each other");
}

/// Of T Y + Y S' or T Y S' - Y: the matrix of the columns of Y, one below the other.
MatrixXd of_stacked_columns(const MatrixXd& T, const MatrixXd& S, LyapunovKind kind) {
  const Index n = T.rows(), columns = S.rows();
  const bool continuous = kind == LyapunovKind::kContinuous;
  MatrixXd M = MatrixXd::Zero(columns * n, columns * n);
  for (Index a = 0; a < columns; ++a) {
    for (Index b = 0; b < columns; ++b) {
      auto part = M.block(a * n, b * n, n, n);
      if (continuous)
        part.diagonal().array() += S(a, b);
      else
        part += S(a, b) * T;
      if (a != b) continue;
      if (continuous)
        part += T;
      else
        part.diagonal().array() -= 1.0;
    }
  }
  return M;
}

/// In the basis of the real Schur form, T = U' A U, the columns of Y = U' X U follow from the last to the first, those
/// of a pair of complex eigenvalues together: T Y_j + Y_j T_jj' = -Q_j - sum_{k > j} Y_k T_jk', and likewise.
MatrixXd solved(const MatrixXd& A, const MatrixXd& Q, LyapunovKind kind) {
  const RealSchur schur = real_schur(A);
  const MatrixXd& T = schur.T;
  const MatrixXd Qt = product(transposed_product(schur.U, Q), schur.U);
  const Index n = A.rows();
  MatrixXd Y = MatrixXd::Zero(n, n);
  for (Index end = n; end > 0;) {
    const Index size = end > 1 && T(end - 1, end - 2) != 0.0 ? 2 : 1;
    const Index begin = end - size;
    MatrixXd later = product_transposed(Y.rightCols(n - end), T.block(begin, end, size, n - end));
    if (kind == LyapunovKind::kDiscrete) later = product(T, later);
    const MatrixXd right = -Qt.middleCols(begin, size) - later;
    const Eigen::VectorXd columns =
        solve_linear(of_stacked_columns(T, T.block(begin, begin, size, size), kind),
                     Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(right.data(), right.size())));
    Y.middleCols(begin, size) = Eigen::Map<const MatrixXd>(columns.data(), n, size);
    end = begin;
  }
  const MatrixXd X = product_transposed(product(schur.U, Y), schur.U);
  return 0.5 * (X + X.transpose());
}

double share(const MatrixXd& left, std::initializer_list<double> terms) {
  const double largest = std::max(terms);
  return largest > 0.0 ? left.norm() / largest : 0.0;
}

}  // namespace

MatrixSolution lyapunov(const MatrixXd& A, const MatrixXd& Q) {
  check_sizes(A, Q);
  check_regular(A, LyapunovKind::kContinuous);
  MatrixSolution s;
  s.X = solved(A, Q, LyapunovKind::kContinuous);
  const MatrixXd AX = product(A, s.X);
  s.residual = share(AX + AX.transpose() + Q, {AX.norm(), Q.norm()});
  return s;
}

MatrixSolution discrete_lyapunov(const MatrixXd& A, const MatrixXd& Q) {
  check_sizes(A, Q);
  check_regular(A, LyapunovKind::kDiscrete);
  MatrixSolution s;
  s.X = solved(A, Q, LyapunovKind::kDiscrete);
  const MatrixXd AXA = product_transposed(product(A, s.X), A);
  s.residual = share(AXA - s.X + Q, {AXA.norm(), s.X.norm(), Q.norm()});
  return s;
}

}  // namespace veridyn::numerics
