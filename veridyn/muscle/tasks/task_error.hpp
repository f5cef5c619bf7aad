#pragma once

#include <span>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/regression/regression_data.hpp"

namespace veridyn::muscle {

/// How far a prediction is from a task's target. Samples where either is NaN do not count.
struct TaskError {
  double rmse = 0.0;  ///< of all outputs together, in their unit; NaN: the simulation could not finish
  /// Mean over the outputs that move of RMSE / (max - min of the target); NaN: the simulation could not finish, or no
  /// output of the target moves.
  double nrmse = 0.0;
  double range = 0.0;  ///< of the target: the largest of any output
  bool moves = false;  ///< some output of the target moves by `least_range` or more
};

/// Motion below which a target has no NRMSE: 1 deg of an angle [rad]; of other outputs as many metres.
inline constexpr double kLeastRange = kDegree;

/// `target` and `predicted` are samples x outputs; an empty prediction is a simulation that could not finish.
/// @throws std::invalid_argument when other sizes differ.
[[nodiscard]] TaskError task_error(const estimation::RowMatrix& target, const estimation::RowMatrix& predicted,
                                   double least_range = kLeastRange);

}  // namespace veridyn::muscle
