#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"

#include <Eigen/Eigenvalues>

#include "veridyn/core/assert.hpp"

namespace veridyn::numerics {

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix) {
  VERIDYN_ASSERT(matrix.rows() == matrix.cols());
  if (matrix.rows() == 0) return {.values = Eigen::VectorXd(0), .vectors = matrix};
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  return {.values = solver.eigenvalues(), .vectors = solver.eigenvectors()};
}

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix) {
  VERIDYN_ASSERT(matrix.rows() == matrix.cols());
  if (matrix.rows() == 0) return Eigen::VectorXd(0);
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::MatrixXd from_eigen(const Eigen::MatrixXd& vectors, const Eigen::VectorXd& values) {
  return vectors * values.asDiagonal() * vectors.transpose();
}

}  // namespace veridyn::numerics
