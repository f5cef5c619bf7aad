#pragma once

#include <Eigen/Core>

namespace veridyn::numerics {

// Products of matrices of any size, compiled once: each such expression that a source writes out costs it seconds.

/// A B
[[nodiscard]] Eigen::MatrixXd product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
/// A B C
[[nodiscard]] Eigen::MatrixXd product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& C);
/// A' B
[[nodiscard]] Eigen::MatrixXd transposed_product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
/// A B'
[[nodiscard]] Eigen::MatrixXd product_transposed(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
/// diag(left) A diag(right): rows and columns scaled.
[[nodiscard]] Eigen::MatrixXd scaled(const Eigen::VectorXd& left, const Eigen::MatrixXd& A,
                                     const Eigen::VectorXd& right);
/// R^-1 B of an upper triangle.
[[nodiscard]] Eigen::MatrixXd solve_upper(const Eigen::MatrixXd& R, const Eigen::MatrixXd& B);
/// The same for one right-hand side.
[[nodiscard]] Eigen::VectorXd solve_upper(const Eigen::MatrixXd& R, const Eigen::VectorXd& b);

}  // namespace veridyn::numerics
