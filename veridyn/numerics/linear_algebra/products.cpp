#include "veridyn/numerics/linear_algebra/products.hpp"

namespace veridyn::numerics {

Eigen::MatrixXd product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) { return A * B; }

Eigen::MatrixXd product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& C) {
  return product(product(A, B), C);
}

Eigen::MatrixXd transposed_product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) { return A.transpose() * B; }

Eigen::MatrixXd product_transposed(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) { return A * B.transpose(); }

Eigen::MatrixXd scaled(const Eigen::VectorXd& left, const Eigen::MatrixXd& A, const Eigen::VectorXd& right) {
  return left.asDiagonal() * A * right.asDiagonal();
}

Eigen::MatrixXd solve_upper(const Eigen::MatrixXd& R, const Eigen::MatrixXd& B) {
  return R.triangularView<Eigen::Upper>().solve(B);
}

Eigen::VectorXd solve_upper(const Eigen::MatrixXd& R, const Eigen::VectorXd& b) {
  return R.triangularView<Eigen::Upper>().solve(b);
}

}  // namespace veridyn::numerics
