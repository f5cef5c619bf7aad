#include "veridyn/muscle/sensitivity/muscle_sensitivity.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/simulation/wrap_bands.hpp"
#include "veridyn/muscle/tasks/task_error.hpp"
#include "veridyn/numerics/batches/block_store.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::muscle {
namespace {

/// Sentences on the side changes and ends of cylinders that the standard model's motion of a task passes.
std::vector<std::string> bands_of(const PreparedTask& task, double accuracy) {
  Progress alone;
  const ForwardOptions options{
      .begin = task.time.front(), .end = task.time.back(), .rate_Hz = task.task.rate_Hz, .accuracy = accuracy};
  const MuscleTrajectory motion = simulate_forward(*task.system, task.start, task.controls, options, alone);
  std::vector<std::string> sentences;
  for (const WrapBandVisit& visit : wrap_band_visits(*task.system, motion.time, motion.q))
    sentences.push_back(wrap_band_text(*task.system, visit));
  return sentences;
}

/// What is known of the tasks before anything is sampled.
std::vector<TaskFinding> find_bands(std::span<const PreparedTask> tasks, double accuracy, Progress& progress) {
  std::vector<TaskFinding> findings(tasks.size());
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    findings[t].name = tasks[t].task.name;
    findings[t].number = tasks[t].task.number;
    findings[t].obstacle = tasks[t].trouble;
    if (findings[t].obstacle.empty() && !(tasks[t].reserve_share <= kMostReserveShare))
      findings[t].obstacle = fmt::format(
          "the standard model's muscles cannot perform it: reserves add up to {:.2g} % of "
          "their moment",
          100.0 * tasks[t].reserve_share);
  }
  const auto one = [&](std::size_t t) {
    if (tasks[t].usable()) findings[t].wrap_bands = bands_of(tasks[t], accuracy);
  };
  static_cast<void>(numerics::parallel_for(tasks.size(), progress.threads(), one,
                                           [&](std::size_t) { return !progress.interrupted(); }));
  return findings;
}

/// The findings with the obstacles that the sampling shows.
std::vector<TaskFinding> judged_tasks(const TaskResponses& responses, const MuscleSampling& sampling,
                                      std::vector<TaskFinding> findings) {
  constexpr double kMostFailed = 0.05;
  for (std::size_t t = 0; t < findings.size(); ++t) {
    TaskFinding& f = findings[t];
    f.failed = at(sampling.failed.col(t).sum());
    if (!f.obstacle.empty()) continue;
    const double all = static_cast<double>(sampling.samples) * static_cast<double>(sampling.failed.rows());
    const estimation::RowMatrix& target = responses.target(t);
    if (target.size() == 0) {
      f.obstacle = "the standard model's motion cannot be simulated";
    } else if (!task_error(target, target).moves) {
      f.obstacle = "the standard model moves by less than 1 deg";
    } else if (static_cast<double>(f.failed) > kMostFailed * all) {
      f.obstacle = fmt::format("{} of {} simulations could not finish", f.failed, all);
    }
  }
  return findings;
}

/// A cover, and whether tasks that pass such a pose could be chosen.
struct ChosenCover {
  TaskCover cover;
  bool bands_allowed = false;
};

/// Cover from the tasks without an obstacle and outside the bands; with those inside where a muscle needs them.
ChosenCover chosen_cover(const Eigen::MatrixXd& mean_nrmse, const std::vector<TaskFinding>& tasks,
                         const CoverOptions& options) {
  std::vector<bool> clean, possible;
  for (const TaskFinding& f : tasks) {
    possible.push_back(f.obstacle.empty());
    clean.push_back(f.obstacle.empty() && f.wrap_bands.empty());
  }
  const TaskCover outside = choose_tasks(mean_nrmse, clean, options);
  if (clean == possible) return {outside, false};
  const TaskCover all = choose_tasks(mean_nrmse, possible, options);
  // A muscle that only tasks in a band excite, or too few tasks outside one.
  const bool needed = all.chosen && (!outside.chosen || outside.unexcited.size() > all.unexcited.size() ||
                                     outside.chosen->tasks.size() < all.chosen->tasks.size());
  return {needed ? all : outside, needed};
}

std::string names_of(const std::vector<std::size_t>& which, const std::vector<std::string>& names) {
  std::vector<std::string> chosen;
  for (const std::size_t i : which) chosen.push_back(names[i]);
  return fmt::format("{}", fmt::join(chosen, ", "));
}

/// What of the sampling and the choice has to be warned of.
std::vector<std::string> warnings_of(const SensitivityStudyOptions& options, const MuscleSensitivity& s) {
  std::vector<std::string> warnings;
  for (const TaskFinding& f : s.tasks) {
    if (!f.obstacle.empty()) warnings.push_back(fmt::format("{}: not to be chosen, {}", f.name, f.obstacle));
    if (f.obstacle.empty() && f.failed > 0)
      warnings.push_back(fmt::format("{}: {} simulations could not finish and do not count", f.name, f.failed));
  }
  if (!s.cover.chosen) return warnings;
  if (!s.cover.unexcited.empty())
    warnings.push_back(fmt::format("no task excites {}: NRMSE below {:g} in all that may be chosen",
                                   names_of(s.cover.unexcited, s.muscles), options.cover.least_nrmse));
  if (s.cover.missed > 0)
    warnings.push_back(
        fmt::format("{} tasks cannot excite every muscle: {} of {} are; choose more, or lower the "
                    "share of the greatest NRMSE from {:g} %",
                    s.cover.chosen->tasks.size(), s.cover.chosen->excited, s.cover.chosen->excited + s.cover.missed,
                    100.0 * options.cover.share));
  if (options.cover.tasks > s.cover.chosen->tasks.size())
    warnings.push_back(fmt::format("only {} tasks may be chosen, {} were asked for", s.cover.chosen->tasks.size(),
                                   options.cover.tasks));
  if (!s.bands_allowed) return warnings;
  for (const std::size_t t : s.cover.chosen->tasks) {
    for (const std::string& band : s.tasks[t].wrap_bands)
      warnings.push_back(fmt::format("{} is chosen although: {}", s.tasks[t].name, band));
  }
  return warnings;
}

}  // namespace

void SensitivityStudyOptions::validate() const {
  if (sampling.samples < 1) throw InputError("sensitivity.samples", "is 0; must be >= 1");
  if (!(sampling.range > 0.0 && sampling.range < 0.5))
    throw InputError("sensitivity.range", fmt::format("is {}; must be > 0 and below 0.5", sampling.range));
  cover.validate();
  if (indices.method == IndexMethod::kVariance) indices.variance.validate();
}

MuscleSensitivity analyse_sensitivity(const MusculoskeletalSystem& subject, std::span<const PreparedTask> tasks,
                                      const SensitivityStudyOptions& options, numerics::BlockStore& store,
                                      Progress& progress) {
  options.validate();
  MuscleSensitivity s;
  const Model& model = subject.model();
  for (const Muscle& m : model.muscles) s.muscles.push_back(m.name());
  const double accuracy = options.sampling.accuracy;
  s.tasks = find_bands(tasks, accuracy, progress);
  const std::vector<MuscleUnknown> factors = muscle_factors(model, options.sampling.range);
  const TaskResponses responses(subject, factors, tasks, accuracy);
  progress.stage(
      fmt::format("{} samples of {} muscles in {} tasks", options.sampling.samples, s.muscles.size(), tasks.size()));
  s.sampling = sample_muscles(responses, options.sampling, store, progress);
  s.completed = s.sampling.completed;
  if (!s.completed) return s;
  s.tasks = judged_tasks(responses, s.sampling, std::move(s.tasks));
  const ChosenCover chosen = chosen_cover(s.sampling.mean, s.tasks, options.cover);
  s.cover = chosen.cover;
  s.bands_allowed = chosen.bands_allowed;
  s.warnings = warnings_of(options, s);
  if (!s.cover.chosen || options.indices.method == IndexMethod::kNone) return s;
  progress.stage(fmt::format("indices of {} tasks", s.cover.chosen->tasks.size()));
  std::vector<std::string> names;
  for (const TaskFinding& f : s.tasks) names.push_back(f.name);
  const TaskResponses varied(subject, options.inputs.empty() ? factors : options.inputs, tasks, accuracy);
  s.indices = task_indices(varied, s.cover.chosen->tasks, names, options.indices, store, progress);
  s.completed = s.indices.completed;
  s.warnings.insert(s.warnings.end(), s.indices.warnings.begin(), s.indices.warnings.end());
  return s;
}

MuscleSensitivity analyse_sensitivity(const MusculoskeletalSystem& subject, std::span<const PreparedTask> tasks,
                                      const SensitivityStudyOptions& options, Progress& progress) {
  numerics::BlockStore nothing;
  return analyse_sensitivity(subject, tasks, options, nothing, progress);
}

}  // namespace veridyn::muscle
