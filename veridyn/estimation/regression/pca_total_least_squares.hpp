#pragma once

#include <Eigen/Core>

#include "veridyn/estimation/regression/total_least_squares.hpp"

namespace veridyn::estimation {

/// GTLS over the directions of the data that exceed the errors (principal-component TLS, Laban 1994).
///
/// Singular values are those of D C^-1 with W = C'C (see WhitenedRegression), so they are in units of the errors'
/// standard deviation and the threshold (S/n + 1) sqrt(N - n_p) needs no tuning to the units or scaling of the data:
/// s_j^2 is signal + noise power. Directions j with s_j above it are excited. With k of them fewer than the
/// noise-bearing regressors, every [theta; -1] in the span of the other right singular vectors explains the data
/// equally well; the one with the smallest |U (theta - theta_0)| is taken (U = diag(weight)). Exact regressors have no
/// errors and no threshold: they drop out only when linearly dependent.
struct PcaTotalLeastSquares {
  bool solved = false;
  Eigen::VectorXd theta;
  Eigen::VectorXd singular_values;
  double threshold = 0.0;
  double error_scale = 0.0;             ///< c of the smallest singular value
  Eigen::Index excited_directions = 0;  ///< k plus the exact ones
  /// Orthonormal in U-weighted coordinates: U^-1 times these are parameter directions. Changes of theta along the first
  /// do not show in the data; along the second they do.
  Eigen::MatrixXd unexcited;  ///< n x (n - excited)
  Eigen::MatrixXd excited;    ///< n x excited
  Eigen::MatrixXd jacobian;   ///< M = X'X - s_min^2 W_xx
  /// U^-1 E (E' U^-1 M U^-1 E)^-1 E' U^-1: takes the score covariance to that of theta's excited part; equals M^-1 when
  /// all is excited.
  Eigen::MatrixXd inverse_on_excited;
};

/// @param scale_known false multiplies the threshold by sqrt(c)
/// @param weight finite and > 0 (pinned parameters are eliminated by `pin_parameters` before)
[[nodiscard]] PcaTotalLeastSquares pca_total_least_squares(const Eigen::MatrixXd& triangle,
                                                           const Eigen::MatrixXd& error_covariance, double rows,
                                                           double signal_to_noise, bool scale_known,
                                                           const Eigen::VectorXd& prior, const Eigen::VectorXd& weight);

}  // namespace veridyn::estimation
