#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "veridyn/muscle/identification/muscle_parametric_model.hpp"

namespace veridyn::muscle {

/// What a report has to say of the tasks of an estimate: for each one that passes a side change or a cylinder's end the
/// task, muscle and pose, as it moves with the unknowns `theta` (those that all segments share). Tasks that cannot be
/// simulated are named too.
[[nodiscard]] std::vector<std::string> task_warnings(const MuscleParametricModel& model, const Eigen::VectorXd& theta);

}  // namespace veridyn::muscle
