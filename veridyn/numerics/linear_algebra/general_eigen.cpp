#include "veridyn/numerics/linear_algebra/general_eigen.hpp"

#include <Eigen/Eigenvalues>

#include "veridyn/core/assert.hpp"

namespace veridyn::numerics {

GeneralEigen general_eigen(const Eigen::MatrixXd& matrix) {
  VERIDYN_ASSERT(matrix.rows() == matrix.cols());
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix);
  return {.values = solver.eigenvalues(), .vectors = solver.eigenvectors()};
}

Eigen::VectorXcd general_eigenvalues(const Eigen::MatrixXd& matrix) {
  VERIDYN_ASSERT(matrix.rows() == matrix.cols());
  return Eigen::EigenSolver<Eigen::MatrixXd>(matrix, false).eigenvalues();
}

RealSchur real_schur(const Eigen::MatrixXd& matrix) {
  VERIDYN_ASSERT(matrix.rows() == matrix.cols());
  const Eigen::RealSchur<Eigen::MatrixXd> schur(matrix);
  return {.T = schur.matrixT(), .U = schur.matrixU()};
}

}  // namespace veridyn::numerics
