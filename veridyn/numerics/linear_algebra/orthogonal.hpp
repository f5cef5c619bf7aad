#pragma once

#include <Eigen/Core>
#include <optional>

namespace veridyn::numerics {

/// A = Q R by Householder reflections (Golub & Van Loan, Matrix Computations, 5.2); A has at least as many rows as
/// columns for `R` and `solve`.
class HouseholderQr {
 public:
  explicit HouseholderQr(const Eigen::MatrixXd& matrix);

  /// The upper triangle, columns x columns.
  [[nodiscard]] const Eigen::MatrixXd& R() const { return R_; }
  /// The square orthogonal factor: the first columns span A, the others its complement.
  [[nodiscard]] Eigen::MatrixXd Q() const;
  /// Its first columns, as many as A has, in memory of the size of A.
  [[nodiscard]] Eigen::MatrixXd thin_Q() const;
  /// Q' B
  [[nodiscard]] Eigen::MatrixXd apply_transposed(const Eigen::MatrixXd& B) const;
  [[nodiscard]] Eigen::VectorXd apply_transposed(const Eigen::VectorXd& b) const;
  /// Least-squares solution of A x = b, A of full column rank.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

 private:
  Eigen::MatrixXd reflectors_;
  Eigen::VectorXd coefficients_;
  Eigen::MatrixXd R_;
};

/// What `eliminate` leaves: the first `rank` rows of `rest` depend on A's unknowns, the others do not.
struct Eliminated {
  Eigen::MatrixXd rest;
  Eigen::Index rank = 0;
};
/// Q' B and the rank of A, by QR with column pivoting: pivots below `threshold` times the largest count as zero.
[[nodiscard]] Eliminated eliminate(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double threshold);

/// Least-squares solution of A x = b by QR with column pivoting.
[[nodiscard]] Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// The shortest least-squares solution of A X = B, whatever the rank of A, by a complete orthogonal decomposition.
/// Pivots below `threshold` times the largest count as zero; 0: the machine's precision times the size.
[[nodiscard]] Eigen::MatrixXd shortest_least_squares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                                     double threshold = 0.0);
/// The same for one right-hand side.
[[nodiscard]] Eigen::VectorXd shortest_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                                     double threshold = 0.0);

/// A^-1 B of a regular square matrix, by LU with partial pivoting.
[[nodiscard]] Eigen::MatrixXd solve_linear(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
/// The same for one right-hand side.
[[nodiscard]] Eigen::VectorXd solve_linear(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// A^-1, by LU with full pivoting; nothing where A is singular to working precision.
[[nodiscard]] std::optional<Eigen::MatrixXd> inverse(const Eigen::MatrixXd& A);

}  // namespace veridyn::numerics
