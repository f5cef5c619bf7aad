#pragma once

#include <Eigen/Core>

namespace veridyn::estimation {

/// W with the variance of the regressand raised until the residual is as large as W says (error scale 1): what the
/// errors of the sensors do not explain is taken as error of the equation itself (unmodelled terms, gusts), which sits
/// in z alone. With it GTLS is the estimator of Fuller (1987), Measurement Error Models, sec. 2.2: (X'X - N W_xx)^-1
/// (X'z - N W_xz). Unchanged when W explains the residual already.
[[nodiscard]] Eigen::MatrixXd with_equation_error(const Eigen::MatrixXd& triangle,
                                                  const Eigen::MatrixXd& error_covariance, double rows);

/// W with the errors of the regressors reduced (standard deviations times f in [0, 1]) until the error scale is no less
/// than 1: the other reading of a residual that is smaller than assumed. f = 0 when even exact regressors leave it too
/// small.
[[nodiscard]] Eigen::MatrixXd with_smaller_regressor_errors(const Eigen::MatrixXd& triangle,
                                                            const Eigen::MatrixXd& error_covariance, double rows);

}  // namespace veridyn::estimation
