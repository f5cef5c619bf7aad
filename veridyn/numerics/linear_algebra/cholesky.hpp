#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace veridyn::numerics {

/// A = L L' of a symmetric positive definite matrix (the lower triangle is read).
class Cholesky {
 public:
  explicit Cholesky(const Eigen::MatrixXd& matrix);

  /// Whether the matrix was positive definite to working precision; nothing else may be asked otherwise.
  [[nodiscard]] bool positive_definite() const { return positive_definite_; }
  /// Lower triangle, zeros above.
  [[nodiscard]] const Eigen::MatrixXd& L() const { return L_; }
  /// A^-1 B
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// L^-1 B: whitens what has covariance A.
  [[nodiscard]] Eigen::MatrixXd solve_lower(const Eigen::MatrixXd& B) const;
  /// L'^-1 B
  [[nodiscard]] Eigen::MatrixXd solve_upper(const Eigen::MatrixXd& B) const;

 private:
  Eigen::MatrixXd L_;
  bool positive_definite_ = false;
};

/// P' L D L' P of a symmetric positive or negative semidefinite matrix, with pivoting: for matrices whose definiteness
/// is the question.
class PivotedCholesky {
 public:
  explicit PivotedCholesky(const Eigen::MatrixXd& matrix);

  /// The smallest element of D; NaN where the factorisation failed, so that `smallest_pivot() > limit` is false.
  [[nodiscard]] double smallest_pivot() const { return smallest_pivot_; }
  /// A^-1 B
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

 private:
  Eigen::LDLT<Eigen::MatrixXd> factor_;
  double smallest_pivot_ = 0.0;
};

/// A^-1 B of a symmetric positive or negative semidefinite matrix by L D L' with pivoting: for matrices whose
/// positive definiteness is in doubt.
[[nodiscard]] Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
/// The same for one right-hand side.
[[nodiscard]] Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// x' A^-1 x, as above.
[[nodiscard]] double inverse_quadratic_form(const Eigen::MatrixXd& A, const Eigen::VectorXd& x);

}  // namespace veridyn::numerics
