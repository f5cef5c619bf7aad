#pragma once

#include <span>
#include <string>

#include "veridyn/muscle/sensitivity/muscle_sensitivity.hpp"

namespace veridyn::muscle {

/// sensitivity.csv: a row for each task and muscle with mean, standard deviation and greatest value of the NRMSE, and
/// the simulations that could not finish. Empty cells: none finished.
[[nodiscard]] std::string sensitivity_csv(const MuscleSensitivity& s);
/// tasks.csv: a row a task: chosen, in the runner-up, the muscles that it excites, why it may not be chosen, the wrap
/// bands that it enters; of its computed muscle control the tracking error and the share of the reserves.
[[nodiscard]] std::string task_choice_csv(const MuscleSensitivity& s, std::span<const PreparedTask> tasks);

/// "2, 9, 27": numbers of elbow tasks, or names of a study's own.
[[nodiscard]] std::string task_list(const MuscleSensitivity& s, const TaskSet& set);

}  // namespace veridyn::muscle
