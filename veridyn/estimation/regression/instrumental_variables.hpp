#pragma once

#include <Eigen/Core>

#include "veridyn/estimation/regression/regression_data.hpp"

namespace veridyn::estimation {

/// Parameters by two-stage least squares.
struct InstrumentalEstimate {
  bool usable = false;
  Eigen::VectorXd theta;
  Eigen::MatrixXd covariance;       ///< allows for autocorrelated errors
  double degrees_of_freedom = 0.0;  ///< of the covariance as an estimate: few where the correlation is long
  /// Share of each regressor's variance that the instruments explain (0 of a constant): below a few percent the
  /// estimate leans towards least squares (weak instruments; Stock & Yogo 2005).
  Eigen::VectorXd relevance;
};

/// z = X theta + e where the regressors are correlated with e (a feedback that answers the noise), but `instruments`
/// are not: theta = (X^' X)^-1 X^' z with X^ the projection of X on the instruments (Theil 1953; Wooldridge 2010,
/// sec. 5.2). Columns of X that are exogenous, as the constant, belong among the instruments too. The covariance is the
/// sandwich of long_run_covariance over X^ e. Not usable where rows are too few or the instruments do not move X.
/// @param instruments  as many rows as `data`, at least as many columns as regressors
[[nodiscard]] InstrumentalEstimate instrumental_variables(const RegressionData& data, const RowMatrix& instruments,
                                                          Eigen::Index max_lag);

}  // namespace veridyn::estimation
