#pragma once

#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/regression/regression.hpp"

namespace veridyn::estimation {

/// Do regressors move together? Condition number of X with columns of unit length and variance inflation factors, with
/// care beyond 300 and 10 (Klein & Morelli 2006, sec. 5.5); the row names the parameters. Where directions are held
/// since they are not excited, by the variance inflation of what is estimated alone.
[[nodiscard]] Evidence collinearity(const RegressionEstimate& estimate);

}  // namespace veridyn::estimation
