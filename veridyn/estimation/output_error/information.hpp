#pragma once

#include <Eigen/Core>
#include <optional>

#include "veridyn/estimation/output_error/output_error.hpp"

/// What further measurements would add to an output-error estimate, before they are made.
namespace veridyn::estimation {

/// A with A'A the Fisher information that measurements of all segments of `model`, without gaps, would hold of its free
/// parameters (columns, in order): sum S' R^-1 S at `options.search_start` (default: the parameters' start) with R =
/// diag(noise_start^2), the segments' own unknowns eliminated, priors not included. The same computation as that of
/// `output_error`'s intervals. None where a simulation diverges.
/// @throws InputError when an option is wrong, or the noise is missing.
[[nodiscard]] std::optional<RowMatrix> information_root(const ParametricModel& model, OutputErrorOptions options);

/// (P^-1 + A'A)^-1: the covariance of parameters of covariance `P` after an experiment of information A'A. Written as
/// P - P A' (I + A P A')^-1 A P, which takes a P that is singular.
[[nodiscard]] Eigen::MatrixXd covariance_after(const Eigen::MatrixXd& P, const RowMatrix& information_root);

}  // namespace veridyn::estimation
