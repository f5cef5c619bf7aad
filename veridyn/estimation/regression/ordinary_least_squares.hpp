#pragma once

#include <Eigen/Core>

#include "veridyn/estimation/regression/regression_data.hpp"

namespace veridyn::estimation {

/// OLS and the conditioning of X from the triangle R of [X, z] (`triangle_of`): R = [R_x, r; 0, rho], theta = R_x^-1 r,
/// residual sum of squares rho^2. Its white covariance is rho^2/(N - n_p) times `inverse_normal`.
struct OrdinaryLeastSquares {
  bool full_rank =
      false;  ///< reciprocal condition above 1e-13; otherwise theta is one of many (minimum norm of scaled columns)
  Eigen::VectorXd theta;
  double residual_sum_of_squares = 0.0;
  Eigen::MatrixXd inverse_normal;   ///< (X'X)^-1
  Eigen::VectorXd singular_values;  ///< of X with columns scaled to unit length, descending
  double condition_number = 0.0;    ///< their ratio; infinity when a column is zero
};

/// Solves from the triangle of [X, z].
[[nodiscard]] OrdinaryLeastSquares ordinary_least_squares(const Eigen::MatrixXd& triangle);

}  // namespace veridyn::estimation
