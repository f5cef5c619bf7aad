#pragma once

#include <Eigen/Core>

namespace veridyn::numerics {

/// Correlation that a pair of standard normal variables needs so that their ranks, and with them the uniform variables
/// Phi(x), Phi(y), have correlation `rho`: 2 sin(pi rho/6) (Pearson 1907). Check: 0.5 gives 0.5176380902.
[[nodiscard]] double normal_correlation_for_uniform(double rho);

/// The correlation matrix that is nearest to a symmetric matrix in the Frobenius norm, with no eigenvalue below a
/// floor.
struct NearestCorrelation {
  Eigen::MatrixXd matrix;
  double largest_change = 0.0;  ///< of any entry; 0 when the matrix was a correlation matrix already
  bool converged = true;        ///< entries moved by less than 1e-12 in the last of at most 1000 rounds
};

/// Alternating projections with Dykstra's correction (Higham 2002, IMA J. Numer. Anal. 22:329) onto matrices with
/// eigenvalues >= `floor` and onto matrices with a unit diagonal. `floor` (>= 0) keeps a Cholesky factor in existence.
[[nodiscard]] NearestCorrelation nearest_correlation(const Eigen::MatrixXd& symmetric, double floor = 1e-10);

/// Uniform variables on (0, 1) that are coupled by a normal distribution.
///
/// Elementwise 2 sin(pi rho/6) of a correlation matrix need not be positive definite, nor need a matrix of pairwise
/// rank correlations; it is then replaced by the nearest correlation matrix, and `repair` says by how much.
class GaussianCopula {
 public:
  /// `correlation` [n x n] of the uniform variables: symmetric, unit diagonal, entries in [-1, 1].
  explicit GaussianCopula(const Eigen::MatrixXd& correlation);

  /// Turns independent standard normal columns [n x draws] into coupled uniform ones, in place.
  void couple(Eigen::Ref<Eigen::MatrixXd> normal) const;

  [[nodiscard]] Eigen::Index size() const { return factor_.rows(); }
  /// The correlation of the normal variables, and what had to be repaired of it.
  [[nodiscard]] const NearestCorrelation& repair() const { return repair_; }

 private:
  NearestCorrelation repair_;
  Eigen::MatrixXd factor_;  ///< lower Cholesky factor
};

/// Spearman's rank correlation of the columns of `samples` [N x n]: the correlation of their ranks, ties at their mean
/// rank. A column without variation is uncorrelated with all others. Values must be finite.
[[nodiscard]] Eigen::MatrixXd rank_correlation(const Eigen::MatrixXd& samples);

}  // namespace veridyn::numerics
