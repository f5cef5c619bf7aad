#pragma once

#include <span>
#include <vector>

#include "veridyn/muscle/identification/muscle_parametric_model.hpp"
#include "veridyn/muscle/tasks/task.hpp"
#include "veridyn/muscle/tasks/task_error.hpp"

namespace veridyn::muscle {

/// The task as an estimator sees it; views its system, which must outlive it. A task with trouble has no segment.
[[nodiscard]] MotionSegment segment_of(const PreparedTask& task);
/// Those of all tasks. @throws std::invalid_argument for a task with trouble.
[[nodiscard]] std::vector<MotionSegment> segments_of(std::span<const PreparedTask> tasks);

/// Outputs of each segment of `model` at `theta` (the parameters that all segments share; starts are the segments'
/// own); empty where a simulation cannot finish. On `threads` threads, the same bits on any number of them.
[[nodiscard]] std::vector<estimation::RowMatrix> simulate_tasks(const estimation::ParametricModel& model,
                                                                const Eigen::VectorXd& theta, int threads);

}  // namespace veridyn::muscle
