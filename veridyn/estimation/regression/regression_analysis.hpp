#pragma once

#include <Eigen/Core>
#include <optional>

#include "veridyn/estimation/regression/long_run_covariance.hpp"
#include "veridyn/estimation/regression/ordinary_least_squares.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/estimation/regression/total_least_squares.hpp"

namespace veridyn::estimation::internal {

/// View of data and options with what all methods share on them: checked, row-scaled data and the triangle of one pass
/// over it. Data and options must outlive it.
class RegressionAnalysis {
 public:
  RegressionAnalysis(const RegressionData& data, const RegressionOptions& options);

  [[nodiscard]] RegressionEstimate run(Method method) const;

  [[nodiscard]] const Eigen::MatrixXd& triangle() const { return triangle_; }
  [[nodiscard]] const OrdinaryLeastSquares& least_squares() const { return least_squares_; }
  [[nodiscard]] double rows() const { return static_cast<double>(X().rows()); }
  [[nodiscard]] const RegressionData& data() const { return data_; }
  /// theta of the method (GTLS, PCA-GTLS) if the errors had covariance `W`, what the assumed ones call not excited
  /// held; none where it then has no solution.
  [[nodiscard]] std::optional<Eigen::VectorXd> theta_under(Method method, const Eigen::MatrixXd& W) const;
  /// Residual z - X theta of the scaled rows.
  [[nodiscard]] Eigen::VectorXd residual(const Eigen::VectorXd& theta) const { return z() - X() * theta; }
  [[nodiscard]] const SegmentRanges& segments() const { return segments_; }
  /// W of the method: that of the data, or the identity on its columns with error (TLS).
  [[nodiscard]] Eigen::MatrixXd error_covariance(Method method) const;

 private:
  [[nodiscard]] RegressionEstimate by_ols(RegressionEstimate result) const;
  [[nodiscard]] RegressionEstimate by_tls(RegressionEstimate result) const;
  [[nodiscard]] RegressionEstimate by_pca(RegressionEstimate result) const;
  [[nodiscard]] RegressionEstimate with_intervals(RegressionEstimate result) const;
  [[nodiscard]] const RowMatrix& X() const { return scaled_X_.size() > 0 ? scaled_X_ : data_.regressors; }
  [[nodiscard]] const Eigen::VectorXd& z() const { return scaled_z_.size() > 0 ? scaled_z_ : data_.regressand; }

  const RegressionData& data_;
  const RegressionOptions& options_;
  RowMatrix scaled_X_;  // only with row scales
  Eigen::VectorXd scaled_z_;
  SegmentRanges segments_;
  Eigen::MatrixXd triangle_;
  OrdinaryLeastSquares least_squares_;
  Eigen::VectorXd spread_;  // sum of squares of each column about its mean
  Eigen::VectorXd variance_inflation_;
  std::vector<bool> constant_;
  Eigen::MatrixXd error_covariance_;  // of GTLS, equation error included
  ErrorRatio ratio_ = ErrorRatio::kKnown;
};

}  // namespace veridyn::estimation::internal
