#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/uncertainty/result_indices.hpp"
#include "veridyn/muscle/sensitivity/task_responses.hpp"

namespace veridyn::muscle {

using estimation::IndexMethod;
using estimation::ResultIndices;
using estimation::wide_interval;
/// How indices of tasks are computed.
using TaskIndexOptions = estimation::IndexOptions;

/// Indices of several tasks.
struct TaskIndices {
  std::vector<std::string> inputs;
  std::vector<ResultIndices> results;  ///< by task; of several tasks their sum too
  std::size_t simulations = 0;
  double seconds = 0.0, processor_seconds = 0.0;
  std::vector<std::string> warnings;
  bool completed = true;  ///< false: the progress asked to stop, or blocks of other processes are missing
};

/// Which share of the variance of a task's NRMSE each unknown causes when all of them vary between their bounds,
/// independently and evenly; those that are fixed stay at their start.
/// @param names  of all tasks of `responses`
/// @param store  its batch is called "indices"
[[nodiscard]] TaskIndices task_indices(const TaskResponses& responses, std::span<const std::size_t> tasks,
                                       std::span<const std::string> names, const TaskIndexOptions& options,
                                       numerics::BlockStore& store, Progress& progress);

}  // namespace veridyn::muscle
