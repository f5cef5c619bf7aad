#pragma once

#include <Eigen/Core>
#include <cmath>

namespace veridyn::estimation::testing_support {

/// Errors of three regressors and a constant, correlated among each other and with those of the regressand.
inline Eigen::MatrixXd correlated_errors(double ratio) {
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(5, 5);
  W(1, 1) = ratio;
  W(2, 2) = 0.7 * ratio;
  W(3, 3) = 0.2 * ratio;
  W(4, 4) = 0.1;
  W(1, 2) = W(2, 1) = 0.3 * ratio;
  W(3, 4) = W(4, 3) = 0.05 * std::sqrt(ratio);
  return W;
}

/// Of these regressors.
inline Eigen::VectorXd true_parameters() {
  Eigen::VectorXd theta(4);
  theta << 0.5, -0.7, 0.3, -1.2;
  return theta;
}

}  // namespace veridyn::estimation::testing_support
