#pragma once

#include <Eigen/Core>

namespace veridyn::estimation {

/// Two normal estimates of the same parameters: p of "they agree", from their difference and its covariance (the sum of
/// theirs where they are independent) by chi-square. 1 where the covariance cannot be used: an infinite or zero
/// variance.
[[nodiscard]] double agreement_p(const Eigen::VectorXd& difference, const Eigen::MatrixXd& covariance);

}  // namespace veridyn::estimation
