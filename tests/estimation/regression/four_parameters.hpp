#pragma once

#include <Eigen/Core>

/// A relation of four parameters, the first of them a constant, for tests of regressions.
namespace veridyn::estimation::testing_support {

inline Eigen::VectorXd regression_theta() {
  Eigen::VectorXd theta(4);
  theta << 0.5, -0.7, 0.3, -1.2;
  return theta;
}

/// Covariance of rows [x, z]: equal variances of the regressors but the constant, and that of z.
inline Eigen::MatrixXd errors(double regressors, double regressand) {
  Eigen::MatrixXd W = regressors * Eigen::MatrixXd::Identity(5, 5);
  W(0, 0) = 0.0;
  W(4, 4) = regressand;
  return W;
}

}  // namespace veridyn::estimation::testing_support
