#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "veridyn/estimation/open_loop/open_loop_model.hpp"

namespace veridyn::estimation {

/// What an open-loop model predicts of one segment, and its derivatives: row k states + j is that of state j at sample
/// k. Empty where it diverges.
struct OpenLoopResponse {
  RowMatrix states;                        ///< samples x outputs that are forecast
  Eigen::MatrixXd parameters, conditions;  ///< with respect to all parameters, and to the segment's initial conditions
};

/// Derivatives with respect to parameters that have no variance are not computed, and zero.
/// @param theta  parameters, then the segment's initial conditions
/// @param covariance  of the parameters
[[nodiscard]] OpenLoopResponse open_loop_response(const OpenLoopModel& model, std::size_t segment,
                                                  const Eigen::VectorXd& theta, const Eigen::MatrixXd& covariance);

}  // namespace veridyn::estimation
