#pragma once

#include <Eigen/Core>

#include "veridyn/estimation/regression/regression_data.hpp"

namespace veridyn::aircraft {

/// What a coefficient has beyond its terms and the noise of the sensors may go with the regressors as much as it is
/// left over: then its power E, of which each of p parameters has E/p, is in the estimate as well. A root of E/p
/// (X'X)^-1, the covariance of that [n x n]; as the likelihood to the power 1/(1 + E/p) of output error it does not
/// fall with the number of rows. Directions in which no regressor moves have none.
/// @param unmodelled_share  of the variance of z, as `CoefficientResult::unmodelled_share`
[[nodiscard]] Eigen::MatrixXd model_error(const estimation::RegressionData& data, double unmodelled_share);

}  // namespace veridyn::aircraft
