#include "veridyn/muscle/sensitivity/task_indices.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"

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
  Eigen::MatrixXd points(unit.rows(), signed_index(responses.unknowns().size()));
  for (std::size_t i = 0; i < responses.unknowns().size(); ++i)
    points.col(signed_index(i)).setConstant(responses.unknowns()[i].start);
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const MuscleUnknown& u = responses.unknowns()[inputs[k]];
    points.col(signed_index(inputs[k])) = (u.low + (u.high - u.low) * unit.col(signed_index(k)).array()).matrix();
  }
  return points;
}

ResultIndices indices_of(std::string result, const Eigen::VectorXd& nrmse, const Eigen::MatrixXd& design,
                         const TaskIndexOptions& options, std::vector<std::string>& warnings) {
  ResultIndices r{.result = std::move(result)};
  for (const double e : nrmse) r.failed += std::isfinite(e) ? 0U : 1U;
  if (options.method == IndexMethod::kMorris) {
    r.morris = numerics::morris_effects(design, nrmse);
    return r;
  }
  try {
    r.variance = numerics::variance_indices(nrmse, at(design.cols()), options.variance);
  } catch (const InputError&) {
    warnings.push_back(
        fmt::format("{}: no indices, {} of {} points could not be simulated", r.result, r.failed, nrmse.size()));
  }
  return r;
}

/// One line for a result whose intervals are wide, naming what is influential and uncertain.
void warn_of_wide(const ResultIndices& r, const std::vector<std::string>& inputs, std::size_t samples,
                  std::vector<std::string>& warnings) {
  constexpr double kInfluential = 0.05;
  std::size_t count = 0, total = 0;
  std::string names;
  for (std::size_t i = 0; i < r.variance.inputs.size(); ++i) {
    const numerics::SensitivityIndex& s = r.variance.inputs[i];
    const bool first = wide_interval(s.first, s.first_low, s.first_high);
    const bool all = wide_interval(s.total, s.total_low, s.total_high);
    count += (first ? 1U : 0U) + (all ? 1U : 0U);
    total += 2;
    if ((first || all) && s.total >= kInfluential) names += (names.empty() ? "" : ", ") + inputs[i];
  }
  if (count == 0) return;
  std::string text = fmt::format("{}: {} of {} indices have an interval wider than {:g} % of the index", r.result,
                                 count, total, 100.0 * kWideInterval);
  if (!names.empty()) text += fmt::format(", of influential inputs {}", names);
  warnings.push_back(text +
                     fmt::format("; with {} instead of {} samples they are about half as wide", 4 * samples, samples));
}

}  // namespace

bool wide_interval(double index, double low, double high) { return !(high - low <= kWideInterval * std::abs(index)); }

TaskIndices task_indices(const TaskResponses& responses, std::span<const std::size_t> tasks,
                         std::span<const std::string> names, const TaskIndexOptions& options,
                         numerics::BlockStore& store, Progress& progress) {
  TaskIndices result;
  const std::vector<std::size_t> inputs = varied(responses);
  for (const std::size_t i : inputs) result.inputs.push_back(responses.unknowns()[i].name);
  if (options.method == IndexMethod::kNone || tasks.empty() || inputs.empty()) return result;
  const Eigen::MatrixXd design = options.method == IndexMethod::kVariance
                                     ? numerics::variance_design(inputs.size(), options.variance)
                                     : numerics::morris_design(inputs.size(), options.morris_trajectories,
                                                               options.morris_levels, options.variance.seed);
  const auto begun = std::chrono::steady_clock::now();
  const ResponseTable table =
      respond(responses, values_at(responses, inputs, design), tasks, store, "indices", progress);
  result.simulations = table.simulations;
  result.processor_seconds = table.processor_seconds;
  result.completed = table.completed;
  if (!table.completed) return result;
  for (std::size_t k = 0; k < tasks.size(); ++k)
    result.results.push_back(
        indices_of(names[tasks[k]], table.nrmse.col(signed_index(k)), design, options, result.warnings));
  if (tasks.size() > 1)
    result.results.push_back(
        indices_of("sum of the chosen tasks", table.nrmse.rowwise().sum(), design, options, result.warnings));
  for (const ResultIndices& r : result.results)
    warn_of_wide(r, result.inputs, options.variance.samples, result.warnings);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return result;
}

}  // namespace veridyn::muscle
