#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/muscle/sensitivity/task_responses.hpp"
#include "veridyn/numerics/sensitivity_indices.hpp"

namespace veridyn::muscle {

/// Which indices are computed.
enum class IndexMethod {
  kVariance,  ///< first and total order (Saltelli, Jansen) with bootstrap intervals
  kMorris,    ///< elementary effects: a screening at a small share of the cost
  kNone,
};

/// How indices are computed.
struct TaskIndexOptions {
  IndexMethod method = IndexMethod::kVariance;
  numerics::SensitivityOptions variance = {};
  std::size_t morris_trajectories = 20;
  std::size_t morris_levels = 4;
};

/// Indices of one result: the NRMSE of a task, or their sum over several.
struct ResultIndices {
  std::string result;
  numerics::SensitivityIndices variance = {};       ///< without inputs: Morris, or too few simulations finished
  std::vector<numerics::MorrisEffect> morris = {};  ///< change of NRMSE over the whole range of the input
  std::size_t failed = 0;                           ///< points of which a simulation could not finish
};

/// Indices of several tasks.
struct TaskIndices {
  std::vector<std::string> inputs;
  std::vector<ResultIndices> results;  ///< by task; of several tasks their sum too
  std::size_t simulations = 0;
  double seconds = 0.0, processor_seconds = 0.0;
  std::vector<std::string> warnings;
  bool completed = true;  ///< false: the progress asked to stop, or blocks of other processes are missing
};

/// Intervals wider than this share of their index are warned of.
inline constexpr double kWideInterval = 0.1;
/// Whether the interval of an index is so wide; also where one of them is not finite.
[[nodiscard]] bool wide_interval(double index, double low, double high);

/// Which share of the variance of a task's NRMSE each unknown causes when all of them vary between their bounds,
/// independently and evenly; those that are fixed stay at their start.
/// @param names  of all tasks of `responses`
/// @param store  its batch is called "indices"
[[nodiscard]] TaskIndices task_indices(const TaskResponses& responses, std::span<const std::size_t> tasks,
                                       std::span<const std::string> names, const TaskIndexOptions& options,
                                       numerics::BlockStore& store, Progress& progress);

}  // namespace veridyn::muscle
