#pragma once

#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/regression/regression.hpp"

namespace veridyn::estimation {

/// Do regressors move together? By the condition number of X with columns of unit length (`Check::kCollinearity`), or,
/// where single parameters are inflated beyond its limit or directions are held since they are not excited, by the
/// variance inflation of what is estimated (`Check::kVarianceInflation`); the row names the parameters.
/// @param noise_alone  the residual is no larger than sensor noise: then the error bars of what moves together are
/// right
///   and wide, and only a condition number beyond any sensor's resolution is objected to
[[nodiscard]] Evidence collinearity(const RegressionEstimate& estimate, bool noise_alone = false);

/// A row of `collinearity`.
[[nodiscard]] bool is_collinearity(const Evidence& row);

}  // namespace veridyn::estimation
