#pragma once

#include <Eigen/Core>

#include "veridyn/estimation/regression/regression_data.hpp"

namespace veridyn::aircraft {

/// Error variance of z, and the unexplained variance over what the sensors explain.
struct EquationError {
  double variance;
  double ratio;  ///< not positive where the errors of the regressors explain all
};

/// The regressors' errors are known from their sensors; the error of z is whatever the data show, be it less than the
/// sensors were assumed to leave (then a larger W_zz would hold back the correction of the regressors) or more
/// (equation error).
[[nodiscard]] EquationError equation_error(const estimation::RegressionData& data);

/// The smallest W_zz with which W is still a covariance: what the errors that z shares with the regressors amount to.
[[nodiscard]] double least_response_variance(const Eigen::MatrixXd& W);

/// Residual variance of an estimate over what the errors of a row leave of it, v' W v with v = (theta, -1).
[[nodiscard]] double residual_ratio(const estimation::RegressionData& data, const Eigen::VectorXd& theta);

}  // namespace veridyn::aircraft
