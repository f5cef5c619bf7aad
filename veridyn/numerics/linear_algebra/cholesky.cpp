#include "veridyn/numerics/linear_algebra/cholesky.hpp"

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::numerics {

Cholesky::Cholesky(const Eigen::MatrixXd& matrix) {
  VERIDYN_ASSERT(matrix.rows() == matrix.cols());
  const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
  positive_definite_ = factor.info() == Eigen::Success;
  L_ = factor.matrixL();
}

Eigen::MatrixXd Cholesky::solve(const Eigen::MatrixXd& B) const { return solve_upper(solve_lower(B)); }

Eigen::VectorXd Cholesky::solve(const Eigen::VectorXd& b) const {
  Eigen::VectorXd x = b;
  L_.triangularView<Eigen::Lower>().solveInPlace(x);
  L_.triangularView<Eigen::Lower>().adjoint().solveInPlace(x);
  return x;
}

Eigen::MatrixXd Cholesky::solve_lower(const Eigen::MatrixXd& B) const {
  return L_.triangularView<Eigen::Lower>().solve(B);
}

Eigen::MatrixXd Cholesky::solve_upper(const Eigen::MatrixXd& B) const {
  return L_.triangularView<Eigen::Lower>().adjoint().solve(B);
}

PivotedCholesky::PivotedCholesky(const Eigen::MatrixXd& matrix) : factor_(matrix) {
  VERIDYN_ASSERT(matrix.rows() == matrix.cols());
  smallest_pivot_ = factor_.info() == Eigen::Success ? factor_.vectorD().minCoeff() : kNaN;
}

Eigen::MatrixXd PivotedCholesky::solve(const Eigen::MatrixXd& B) const { return factor_.solve(B); }

Eigen::VectorXd PivotedCholesky::solve(const Eigen::VectorXd& b) const { return factor_.solve(b); }

Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  VERIDYN_ASSERT(A.rows() == A.cols() && A.cols() == B.rows());
  return Eigen::LDLT<Eigen::MatrixXd>(A).solve(B);
}

Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  VERIDYN_ASSERT(A.rows() == A.cols() && A.cols() == b.size());
  return Eigen::LDLT<Eigen::MatrixXd>(A).solve(b);
}

double inverse_quadratic_form(const Eigen::MatrixXd& A, const Eigen::VectorXd& x) {
  return x.dot(solve_symmetric(A, x));
}

}  // namespace veridyn::numerics
