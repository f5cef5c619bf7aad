#pragma once

#include <ceres/problem.h>

#include <Eigen/Core>
#include <vector>

#include "veridyn/estimation/output_error/parametric_model.hpp"

/// How a search is kept off what its data do not determine (`OutputErrorOptions::hold_undetermined`).
namespace veridyn::estimation::internal {

/// Standard deviations of values known only to lie within their bounds.
[[nodiscard]] Eigen::VectorXd bound_sigmas(const std::vector<const ModelParameter*>& unknowns);

/// Directions that the information A'A (A = `information_root`, priors included) determines less than the bounds do, as
/// rows w v' with w so large that a least-squares search with residuals w v' (x - start) does not move along them.
/// Other directions are not held at all: rows are orthogonal to them in units of `bound_sigmas`.
[[nodiscard]] RowMatrix undetermined_rows(const std::vector<const ModelParameter*>& unknowns,
                                          const RowMatrix& information_root);

/// Adds those residuals to a problem whose block `x` are the unknowns.
void hold_undetermined(ceres::Problem& problem, double* x, const std::vector<const ModelParameter*>& unknowns,
                       const RowMatrix& information_root);

}  // namespace veridyn::estimation::internal
