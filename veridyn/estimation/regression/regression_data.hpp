#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace veridyn::estimation {

/// A matrix stored row by row, as samples come.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// What a linear regression z = X theta + error is estimated from.
///
/// N samples (rows), n_p named regressors (columns). The errors of one row, e = [errors of x, error of z], have zero
/// mean and covariance W (`error_covariance`), the same in every row after scaling; they may be autocorrelated.
/// Columns whose row and column in W are zero are exactly known (the constant regressor). Rows must be finite: drop the
/// others with `drop_rows_that_are_not_finite` and give the parts different segment ids, so that no lag is formed
/// across the hole.
struct RegressionData {
  RowMatrix regressors;                      ///< X, N x n_p
  Eigen::VectorXd regressand;                ///< z, N
  std::vector<std::string> parameter_names;  ///< n_p, of theta: "CY_beta"
  std::vector<std::string> parameter_units;  ///< n_p, of theta; empty means dimensionless
  std::string regressand_name = "z";
  /// Segment of each row; equal ids are contiguous. Empty: all rows are one segment. Lags never cross segments.
  std::vector<int> segment;
  /// W of [x, z], (n_p+1) x (n_p+1), symmetric positive semi-definite, with W_zz > 0, in the units of the columns.
  /// It may be singular (errors of alpha and alpha^2 are fully correlated). Empty: regressors exact, error of z
  /// unknown.
  Eigen::MatrixXd error_covariance;
  /// Is W known in absolute terms, or only up to a common factor? Thresholds and the scale test need absolute terms;
  /// without them the factor is estimated from the data. Ignored when W is empty.
  bool error_scale_known = true;
  /// Is W_zz all the error of z? If not it is a lower bound, and GTLS and PCA-GTLS estimate the rest (error of the
  /// equation itself: unmodelled terms, gusts) from the residual; W of the regressors must then be known in absolute
  /// terms (see equation_error.hpp).
  bool regressand_error_known = true;
  /// Standard deviation of the row's errors relative to W (N, > 0); rows are divided by it. Empty: all 1.
  Eigen::VectorXd row_scale;

  [[nodiscard]] Eigen::Index rows() const { return regressors.rows(); }
  [[nodiscard]] Eigen::Index parameters() const { return regressors.cols(); }
  [[nodiscard]] bool has_error_covariance() const { return error_covariance.size() > 0; }

  /// @throws InputError naming what is wrong: sizes, fewer rows than parameters + 1, a value that is not finite (with
  /// row and column), names that repeat, W asymmetric or indefinite, W_zz not positive, segment ids that come back.
  void validate() const;
};

/// Contiguous rows [first, second) of equal segment id; one range when `segment` is empty.
[[nodiscard]] std::vector<std::pair<Eigen::Index, Eigen::Index>> segment_ranges(Eigen::Index rows,
                                                                                std::span<const int> segment);

/// Removes rows with a NaN or infinity; a segment with rows missing in its middle is split into new ids, numbered from
/// 0.
/// @returns how many rows were removed.
Eigen::Index drop_rows_that_are_not_finite(RegressionData& data);

/// W of [regressors, regressand] must be size x size, finite, symmetric, positive semi-definite, with W_zz > 0.
/// @throws InputError naming the element and the rule
void check_error_covariance(const Eigen::MatrixXd& error_covariance, Eigen::Index size);

}  // namespace veridyn::estimation
