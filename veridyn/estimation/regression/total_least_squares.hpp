#pragma once

#include <Eigen/Core>

#include "veridyn/estimation/regression/long_run_covariance.hpp"
#include "veridyn/estimation/regression/regression_data.hpp"

namespace veridyn::estimation {

/// The regression in coordinates where its errors are white: from the triangle R of D = [X, z] and the error covariance
/// W.
///
/// Parameters are written h = [theta; -1], D h = residual. Combinations of columns without any error (the constant
/// regressor, but also any null direction of W such as two regressors computed from the same sensor) span the exact
/// part; the others are combined so that their errors are uncorrelated with unit variance:
///     h = T_e g_e + T_w g_w + T_0 g_0,   D [T_e, T_w] = Q [R11, R12; 0, R22],   T_w' W T_w = I,   W T_e = 0,
/// where T_0 holds exact combinations whose columns are linearly dependent. g_e follows from g_w by R11 g_e = -R12 g_w,
/// so that mixed OLS-TLS (Van Huffel & Vandewalle 1991, sec. 3.6.1) works on R22 alone and no small number stands in
/// for a zero error. R22 and its singular values are in units of the errors' standard deviation: N rows of pure noise
/// give about sqrt(N).
struct WhitenedRegression {
  Eigen::MatrixXd basis;            ///< columns b_j = h of the right singular vector j of R22, exact part eliminated
  Eigen::MatrixXd null_basis;       ///< T_0
  Eigen::VectorXd singular_values;  ///< of R22, descending; one more than noise-bearing regressor combinations
  Eigen::Index exact = 0;           ///< number of exact combinations of full rank
};

/// T_e and T_w of an error covariance: columns without error (and null directions of W), and columns that whiten the
/// others; [T_e, T_w] is square and regular.
struct ErrorBasis {
  Eigen::MatrixXd exact;
  Eigen::MatrixXd white;
};
/// The basis of W; see ErrorBasis.
[[nodiscard]] ErrorBasis error_basis(const Eigen::MatrixXd& error_covariance);

/// The regression of a triangle in coordinates where its errors are white; see WhitenedRegression.
///
/// Null directions of W are those with less than 1e-10 of the largest eigenvalue of its correlation matrix: rounding of
/// a W that was itself computed. Exact columns are dependent below 1e-12 of the largest singular value of unit columns.
[[nodiscard]] WhitenedRegression whiten(const Eigen::MatrixXd& triangle, const Eigen::MatrixXd& error_covariance);

/// Where the ratio between errors of z and of X comes from.
enum class ErrorRatio {
  kKnown,     ///< W is known up to a factor: GTLS
  kEstimated  ///< W_zz was raised to fit the residual: Fuller's estimator, whose score is x_k r_k - (W h)_x
};

/// Total least squares, generalised to errors of covariance W, with its white covariance.
///
/// theta minimises sum (z_k - x_k theta)^2 / (h'Wh): the right singular vector of the smallest singular value s_min.
/// Invariant to units of the columns, since W carries them. Its estimating equation and covariance are derived in
/// docs/estimation.md:
///     score  g_k = x_hat_k r_k,  x_hat = x - (W h)_x r/(h'Wh) (the maximum-likelihood regressor),  r = z - x theta,
///     Jacobian  M = X'X - s_min^2 W_xx,
///     white covariance  s2 M^-1 + N M^-1 [s2 c W_xx - c^2 (W_x h)(W_x h)'] M^-1,  s2 = c h'Wh,  c = s_min^2/(N - n_p).
struct TotalLeastSquares {
  bool solved = false;     ///< theta exists: s_min is simple and its vector has a component along z
  bool full_rank = false;  ///< no dependent exact columns
  Eigen::VectorXd theta;
  double error_scale = 0.0;  ///< c: 1 when W is right in absolute terms
  double smallest = 0.0;     ///< s_min
  Eigen::VectorXd singular_values;
  Eigen::MatrixXd jacobian;          ///< M
  Eigen::MatrixXd inverse_jacobian;  ///< M^-1; empty when M is not positive definite
  Eigen::MatrixXd covariance_white;
  /// Largest share (0..1) of noise in any direction of X'X; 1 is the nongeneric case, without a TLS solution.
  double noise_share = 0.0;
};

/// @param rows N, the number of rows behind the triangle
[[nodiscard]] TotalLeastSquares total_least_squares(const Eigen::MatrixXd& triangle,
                                                    const Eigen::MatrixXd& error_covariance, double rows,
                                                    ErrorRatio ratio = ErrorRatio::kKnown);

/// M = X'X - s^2 W_xx and what follows from it; `inverse` is empty when M is not positive definite.
struct CorrectedNormalMatrix {
  Eigen::MatrixXd matrix;
  Eigen::MatrixXd inverse;
  double noise_share = 0.0;
};
/// See CorrectedNormalMatrix.
[[nodiscard]] CorrectedNormalMatrix corrected_normal_matrix(const Eigen::MatrixXd& triangle,
                                                            const Eigen::MatrixXd& error_covariance, double s_squared);

/// Variance of the sum of scores when errors are white: s2 M + N [s2 c W_xx -+ c^2 (W_x h)(W_x h)'], minus when the
/// ratio is known, plus when it was estimated (Fuller 1987, eq. 2.2.24).
[[nodiscard]] Eigen::MatrixXd white_score_covariance(const Eigen::MatrixXd& jacobian,
                                                     const Eigen::MatrixXd& error_covariance,
                                                     const Eigen::VectorXd& theta, double error_scale, double rows,
                                                     ErrorRatio ratio = ErrorRatio::kKnown);

/// Scores at `theta`: regressors x_hat, residual r = z - X theta, and -(W h)_x where the ratio was estimated.
[[nodiscard]] Scores errors_in_variables_scores(const RowMatrix& regressors, const Eigen::VectorXd& regressand,
                                                const Eigen::MatrixXd& error_covariance, const Eigen::VectorXd& theta,
                                                ErrorRatio ratio);

}  // namespace veridyn::estimation
