#include "veridyn/muscle/sensitivity/task_indices.hpp"

#include <chrono>
#include <utility>

namespace veridyn::muscle {
namespace {

/// Unknowns that vary.
std::vector<std::size_t> varied(const TaskResponses& responses) {
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < responses.unknowns().size(); ++i) {
    if (!responses.unknowns()[i].fixed) chosen.push_back(i);
  }
  return chosen;
}

/// Values of all unknowns at points of the unit cube of those that vary.
Eigen::MatrixXd values_at(const TaskResponses& responses, const std::vector<std::size_t>& inputs,
                          const Eigen::MatrixXd& unit) {
  Eigen::MatrixXd points(unit.rows(), responses.unknowns().size());
  for (std::size_t i = 0; i < responses.unknowns().size(); ++i)
    points.col(i).setConstant(responses.unknowns()[i].start);
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const MuscleUnknown& u = responses.unknowns()[inputs[k]];
    points.col(inputs[k]) = (u.low + (u.high - u.low) * unit.col(k).array()).matrix();
  }
  return points;
}

}  // namespace

TaskIndices task_indices(const TaskResponses& responses, std::span<const std::size_t> tasks,
                         std::span<const std::string> names, const TaskIndexOptions& options,
                         numerics::BlockStore& store, Progress& progress) {
  TaskIndices result;
  const std::vector<std::size_t> inputs = varied(responses);
  for (const std::size_t i : inputs) result.inputs.push_back(responses.unknowns()[i].name);
  if (options.method == IndexMethod::kNone || tasks.empty() || inputs.empty()) return result;
  const Eigen::MatrixXd design = estimation::index_design(inputs.size(), options);
  const auto begun = std::chrono::steady_clock::now();
  const ResponseTable table =
      respond(responses, values_at(responses, inputs, design), tasks, store, "indices", progress);
  result.simulations = table.simulations;
  result.processor_seconds = table.processor_seconds;
  result.completed = table.completed;
  if (!table.completed) return result;
  for (std::size_t k = 0; k < tasks.size(); ++k)
    result.results.push_back(
        estimation::result_indices(names[tasks[k]], table.nrmse.col(k), design, options, result.warnings));
  if (tasks.size() > 1)
    result.results.push_back(estimation::result_indices("sum of the chosen tasks", table.nrmse.rowwise().sum(), design,
                                                        options, result.warnings));
  for (const ResultIndices& r : result.results) {
    std::string warning = estimation::wide_interval_warning(r, result.inputs, options.variance.samples);
    if (!warning.empty()) result.warnings.push_back(std::move(warning));
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return result;
}

}  // namespace veridyn::muscle
