#pragma once

#include <Eigen/Core>

namespace veridyn::estimation {

/// How well two estimates of the same parameters agree.
struct Agreement {
  double p = 1.0;  ///< of "they agree", by chi-square
  /// Chi-square over its degrees of freedom: about 1 where the error bars are right; its root is the factor by which
  /// they are too small (Birge 1932).
  double ratio = 1.0;
};

/// Two normal estimates of the same parameters, from their difference and its covariance (the sum of theirs where they
/// are independent). Both numbers are 1 where the covariance cannot be used: an infinite or zero variance.
[[nodiscard]] Agreement agreement(const Eigen::VectorXd& difference, const Eigen::MatrixXd& covariance);

/// Two normal estimates of the same parameters: the p of their agreement.
[[nodiscard]] double agreement_p(const Eigen::VectorXd& difference, const Eigen::MatrixXd& covariance);

}  // namespace veridyn::estimation
