#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "veridyn/estimation/output_error/parametric_model.hpp"

namespace veridyn::muscle {

/// Combinations of parameters that data leave to the priors.
struct NullDirections {
  std::vector<std::string> texts;  ///< "A, B against C": those that go up against those that go down
  Eigen::MatrixXd vectors;         ///< parameters x directions, in units of the priors, unit length; 0 of fixed ones
};

/// Eigenvectors of a posterior covariance in units of the priors, of which every free parameter has one, the least
/// known first: those along which more than `share` of the prior's variance is left. None where the covariance is not
/// finite.
[[nodiscard]] NullDirections null_directions(std::span<const estimation::ModelParameter> parameters,
                                             const Eigen::MatrixXd& covariance, double share);

}  // namespace veridyn::muscle
