#include "veridyn/muscle/study/identify_muscles.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/muscle/identification/emg_estimate.hpp"
#include "veridyn/muscle/identification/emg_judgement.hpp"
#include "veridyn/muscle/identification/task_posterior.hpp"
#include "veridyn/muscle/identification/task_profiles.hpp"
#include "veridyn/muscle/identification/task_segments.hpp"
#include "veridyn/muscle/identification/task_warnings.hpp"
#include "veridyn/muscle/simulation/wrap_bands.hpp"
#include "veridyn/muscle/study/task_part.hpp"
#include "veridyn/muscle/study/task_recordings.hpp"
#include "veridyn/muscle/tasks/task_error.hpp"
#include "veridyn/numerics/ranks/ranks_progress.hpp"

namespace veridyn::muscle {
namespace {

using estimation::RowMatrix;

/// Standard deviations of the outputs' noise; empty unless all are known.
Eigen::VectorXd stated_noise(const TaskStudy& study) {
  Eigen::VectorXd noise(study.outputs.size());
  for (std::size_t j = 0; j < study.outputs.size(); ++j) {
    if (!(study.outputs[j].noise_sd > 0.0)) return {};
    noise(j) = study.outputs[j].noise_sd;
  }
  return noise;
}

/// How a part's tasks go with the standard model and at `theta`; `predicted` in place of simulations where given.
std::vector<TaskOutcome> outcomes_of(const TaskPart& part, const Eigen::VectorXd& standard,
                                     const Eigen::VectorXd& theta, const std::vector<RowMatrix>& predicted,
                                     bool hold_out, int threads) {
  std::vector<TaskOutcome> outcomes;
  if (part.tasks.empty()) return outcomes;
  std::vector<RowMatrix> before = simulate_tasks(part.model(), standard, threads);
  std::vector<RowMatrix> after = predicted.empty() ? simulate_tasks(part.model(), theta, threads) : predicted;
  for (std::size_t s = 0; s < part.tasks.size(); ++s) {
    TaskOutcome task{.name = part.tasks[s]->name, .hold_out = hold_out, .time = part.tasks[s]->time};
    task.before = task_error(part.measured[s], before[s]);
    task.after = task_error(part.measured[s], after[s]);
    task.measured = part.measured[s];
    task.standard = std::move(before[s]);
    task.estimated = std::move(after[s]);
    task.reserve_share = part.tasks[s]->reserve_share;
    outcomes.push_back(std::move(task));
  }
  return outcomes;
}

/// Unseen tasks, output by output.
std::vector<estimation::PredictedQuantity> predictions_of(const std::vector<TaskOutcome>& tasks,
                                                          std::span<const estimation::ModelOutput> outputs) {
  std::vector<estimation::PredictedQuantity> list;
  for (std::size_t j = 0; j < outputs.size(); ++j) {
    std::vector<double> measured, predicted;
    double cross = 0.0, squares = 0.0;
    for (const TaskOutcome& t : tasks) {
      if (!t.hold_out || t.estimated.size() == 0) continue;
      double before = kNaN;
      for (Eigen::Index k = 0; k < t.measured.rows(); ++k) {
        const double z = t.measured(k, j), y = t.estimated(k, j);
        if (std::isnan(z)) continue;
        measured.push_back(z);
        predicted.push_back(y);
        squares += (y - z) * (y - z);
        if (!std::isnan(before)) cross += before * (y - z);
        before = y - z;
      }
    }
    if (measured.empty()) continue;
    list.push_back({.name = outputs[j].name,
                    .unit = outputs[j].unit,
                    .fit = numerics::fit_measures(measured, predicted),
                    .lag1 = squares > 0.0 ? cross / squares : 0.0});
  }
  return list;
}

Model with_values(const TaskStudy& study, std::span<const estimation::Parameter> parameters) {
  Model model = study.subject.written;
  const Model& own = study.subject.system->model();
  for (const MuscleUnknown& u : study.unknowns) {
    const estimation::Parameter* p = estimation::find_parameter(parameters, u.name);
    if (p == nullptr || u.fixed || !std::isfinite(p->value)) continue;
    for (const MuscleParameterName& name : u.parameters) {
      if (name.of_excitation()) continue;
      Muscle& muscle = model.muscles[model.muscle(own.muscles[name.muscle].name())];
      double& value = field_of(muscle.parameters.musculotendon, name.field);
      value = u.factor ? value * p->value : p->value;
    }
  }
  return model;
}

/// Mean NRMSE of the tasks, of those trained and those held out, by the names that estimate.json has for them.
std::map<std::string, double> fit_of(const std::vector<TaskOutcome>& tasks) {
  std::map<std::string, double> fit;
  for (const bool hold_out : {false, true}) {
    double sum = 0.0, count = 0.0;
    for (const TaskOutcome& t : tasks) {
      if (t.hold_out != hold_out || !std::isfinite(t.after.nrmse)) continue;
      sum += t.after.nrmse;
      count += 1.0;
    }
    if (count > 0.0) fit[hold_out ? "nrmse_unseen" : "nrmse_trained"] = sum / count;
  }
  return fit;
}

/// The group of all muscles' parameters as rows judge it, still without parameters.
estimation::ParameterGroup judged_group(const std::string& title, std::vector<estimation::Evidence> rows) {
  estimation::ParameterGroup group{.name = title, .meaning = "muscles"};
  group.judgement = estimation::judge(rows);
  group.verdict = estimation::verdict_of(group.judgement);
  group.evidence = std::move(rows);
  return group;
}

std::string method_of(const TaskStudy& study) {
  if (study.published) return "particle swarm, then pattern search over all tasks";
  return study.emg ? "generalised least squares along the recorded angles of all tasks" : "output error over all tasks";
}

/// A residual beyond the noise widens what it cannot refuse (Birge 1932): the factor of all variances.
double widening_of(const TaskEstimate& e) { return e.chi_square > 1.0 ? e.chi_square : 1.0; }

/// The estimate's parameters with their intervals widened, as the group's verdict marks them.
std::vector<estimation::Parameter> judged_parameters(const TaskEstimate& e, estimation::GroupVerdict verdict) {
  std::vector<estimation::Parameter> parameters = e.best.parameters;
  for (estimation::Parameter& p : parameters) {
    if (p.status == estimation::ParameterStatus::kFixed) continue;
    if (widening_of(e) > 1.0 && std::isfinite(p.sigma)) {
      p.sigma *= std::sqrt(widening_of(e));
      estimation::set_interval(p, std::max(1.0, e.best.degrees_of_freedom));
    }
  }
  return estimation::marked(std::move(parameters), verdict);
}

/// The group's verdict in a sentence.
std::string reason_of(const estimation::ParameterGroup& group, const std::vector<TaskOutcome>& tasks) {
  if (group.verdict == estimation::GroupVerdict::kIdentified)
    return fmt::format(
        "{} of {} parameters identified from {} tasks",
        std::ranges::count(group.parameters, estimation::ParameterStatus::kIdentified, &estimation::Parameter::status),
        group.parameters.size(), std::count_if(tasks.begin(), tasks.end(), [](const auto& t) { return !t.hold_out; }));
  if (group.verdict == estimation::GroupVerdict::kEffective)
    return "predicts, but its values are no physical constants";
  const auto& why = group.judgement.parameters.decided_by;
  return fmt::format("rejected: {}", why.empty() ? "it could not be judged" : why.front());
}

/// What to perform next, unless something other than too few tasks speaks against the parameters.
TaskAdvice advice_for(const TaskStudy& study, const MuscleParametricModel& model, const TaskEstimate& estimate,
                      const std::vector<estimation::Evidence>& rows, Progress& progress) {
  const auto begun = std::chrono::steady_clock::now();
  TaskAdvice advice;
  for (const estimation::Evidence& row : rows) {
    // More tasks mend these.
    if (row.check == estimation::Check::kDeterminedByTasks || row.check == estimation::Check::kDistanceFromStart)
      continue;
    if (row.outcome != estimation::Outcome::kFailed || !row.bears_on.contains(estimation::Purpose::kParameters))
      continue;
    advice.withheld = estimation::says(row);
    return advice;
  }
  std::vector<int> used;
  for (const Task& task : study.tasks) used.push_back(task.number);
  std::vector<std::string> left_out;
  progress.stage("which further task would tell most");
  const std::vector<PreparedTask> candidates =
      candidate_tasks(*study.subject.system, *study.elbow, used, left_out, progress);
  if (progress.interrupted()) return advice;
  advice = advise_task(*study.subject.system, model, model_options(study), estimate, candidates, progress);
  advice.left_out.insert(advice.left_out.begin(), left_out.begin(), left_out.end());
  advice.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return advice;
}

/// The best tasks of an advice, as the estimate names them.
std::vector<estimation::NextMeasurement> next_measurements(const TaskAdvice& advice) {
  constexpr std::size_t kNamed = 3;
  std::vector<estimation::NextMeasurement> next;
  for (std::size_t i = 0; i < std::min(kNamed, advice.tasks.size()); ++i) {
    const AdvisedTask& task = advice.tasks[i];
    next.push_back({task.name, advice.now.parameter, advice.now.share, task.then.parameter, task.then.share});
  }
  return next;
}

/// What a route found, and what it asked of the model.
struct RouteResult {
  TaskEstimate estimate;
  EmgEstimate emg;  ///< with EMG: what profiles need
  std::vector<estimation::ModelEvaluation> evaluations;
  std::size_t resumed = 0;
  std::vector<std::string> warnings;
};

/// By the published search.
RouteResult by_published_route(const TaskStudy& study, const SearchedTasks& searched, const Eigen::VectorXd& noise,
                               numerics::ValueLog* log, Progress& progress) {
  const TaskPart& part = *searched.part;
  PublishedRouteOptions options = *study.published;
  if (log != nullptr && options.evaluation.log.empty()) options.evaluation.log = log->folder() / "search.csv";
  PublishedRouteResult found = published_route(*part.forward, part.measured, options, progress, &searched.shared);
  RouteResult result;
  result.evaluations = std::move(found.evaluations);
  result.resumed = found.resumed * part.tasks.size();
  if (found.theta.size() == 0 || progress.interrupted()) {
    result.estimate.best.message = found.message();
    return result;
  }
  for (std::size_t s = 0; s < found.nrmse.size(); ++s) {
    if (!(found.nrmse[s] <= options.tolerance))
      result.warnings.push_back(
          fmt::format("the published search ended with an NRMSE of {:.2g} in {}, more than the "
                      "tolerance of {:.2g}: {}",
                      found.nrmse[s], part.tasks[s]->name, options.tolerance, found.pattern.message()));
  }
  TaskSearch search{.steps = static_cast<int>(result.evaluations.size()), .message = found.message()};
  result.estimate = describe_estimate(searched.logged, part.measured, noise, found.theta, std::move(search), progress);
  result.estimate.seconds = found.seconds;
  result.estimate.simulations = {.values = found.simulations};
  return result;
}

/// By the route that the study asks for.
RouteResult by_route(const TaskStudy& study, const SearchedTasks& searched, const Eigen::VectorXd& noise,
                     numerics::ValueLog* log, Progress& progress) {
  if (study.published) return by_published_route(study, searched, noise, log, progress);
  const TaskPart& part = *searched.part;
  RouteResult result;
  if (part.along) {
    result.emg = estimate_from_emg(*part.along, searched.logged, part.measured, noise, study.search, progress);
    result.estimate = result.emg.estimate;
  } else {
    result.estimate = estimate_from_tasks(searched.logged, part.measured, noise, study.search, progress);
  }
  result.evaluations = searched.logged.evaluations();
  result.resumed = searched.logged.resumed();
  return result;
}

/// Profiles, where the study asks for them.
estimation::ProfileResult profiles_of(const TaskStudy& study, const SearchedTasks& searched,
                                      const Eigen::VectorXd& noise, const RouteResult& found, Progress& progress) {
  if (study.profiles.empty()) return {};
  progress.stage(fmt::format("profile likelihood of {} parameters", study.profiles.size()));
  if (!study.emg)
    return profile_tasks(searched.logged, searched.part->measured, noise, found.estimate, study.profiles, progress);
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(study.outputs.size());
  return profile_tasks(*found.emg.model, found.emg.measured, one, found.estimate, study.profiles, progress);
}

/// The posterior, where the study asks for it. The densities are kept, a number each, not the responses.
estimation::PosteriorSample posterior_of(const TaskStudy& study, const SearchedTasks& searched,
                                         const RouteResult& found, numerics::ValueLog* log, Progress& progress) {
  if (!study.posterior || progress.interrupted()) return {};
  progress.stage(fmt::format("posterior of {} parameters", study.unknowns.size()));
  if (!study.emg)
    return sample_tasks(searched.shared, searched.part->measured, found.estimate, *study.posterior, progress, log);
  const AboutEmgErrors about = found.emg.about->on(searched.shared);
  return sample_tasks(found.emg.model->on(about), found.emg.measured, found.estimate, *study.posterior, progress, log);
}

/// Why no search came to an end, with the first task that cannot be simulated where the first search begins.
std::string why_diverged(const TaskStudy& study, const TaskPart& part, const TaskEstimate& e) {
  std::string text = e.best.message.empty() ? "no search came to an end" : e.best.message;
  const Eigen::VectorXd start = study.search.first.size() > 0 ? study.search.first : start_values(study.unknowns);
  for (std::size_t s = 0; s < part.tasks.size(); ++s) {
    const std::string trouble = part.along ? part.along->trouble(s, start) : part.forward->trouble(s, start);
    if (!trouble.empty()) return fmt::format("{}; {}: {}", text, part.tasks[s]->name, trouble);
  }
  return text;
}

/// What the paths of the tasks have to be warned of.
std::vector<std::string> path_warnings(const TaskStudy& study, const TaskPart& part, const Eigen::VectorXd& theta) {
  if (part.forward) return task_warnings(*part.forward, theta);
  std::vector<std::string> warnings;
  for (const TaskRecording* task : part.tasks) {
    for (const WrapBandVisit& visit : wrap_band_visits(*study.subject.system, task->time, task->q))
      warnings.push_back(fmt::format("{}: {}", task->name, wrap_band_text(*study.subject.system, visit)));
  }
  return warnings;
}

/// The rows that judge the estimate; those about EMG where the study has it.
std::vector<estimation::Evidence> judged(const TaskStudy& study, const TaskPart& trained, const MuscleAnalysis& a,
                                         const std::vector<std::string>& wraps, const Eigen::VectorXd& noise) {
  std::vector<estimation::Evidence> rows = judge_tasks({.estimate = a.result,
                                                        .tasks = a.tasks,
                                                        .unused = a.unused,
                                                        .wrap_warnings = wraps,
                                                        .noise_known = noise.size() > 0,
                                                        .noise = noise.size() > 0 ? noise(0) : 0.0,
                                                        .simulated = study.person.has_value(),
                                                        .along_angles = study.emg.has_value()});
  if (!study.emg) return rows;
  for (estimation::Evidence& row : judge_emg({.model = *trained.along,
                                   .system = *study.subject.system,
                                   .theta = a.result.best.theta,
                                   .tasks = a.tasks,
                                   .error = study.emg->error,
                                   .error_factors = a.emg_error_factors,
                                   .outputs = study.outputs}))
    rows.push_back(std::move(row));
  return rows;
}

}  // namespace

MuscleAnalysis identify(const TaskStudy& study, Progress& progress, numerics::ValueLog* log,
                        const numerics::Ranks& ranks) {
  MuscleAnalysis a;
  TaskRecordings all = task_recordings(study, progress);
  a.interrupted = progress.interrupted();
  if (a.interrupted) return a;
  a.preparing_s = all.seconds;
  a.truth = all.truth;
  const TaskPart trained = task_part(study, all, false), unseen = task_part(study, all, true);
  if (trained.tasks.empty())
    throw InputError(study.subject.title,
                     fmt::format("no task is left to estimate from: {}", fmt::join(all.unused, "; ")));
  numerics::SharedWork work(ranks, fingerprint_of(study, trained), progress.threads(),
                            estimation::SharedModel::responses_of(trained.model()));
  if (!ranks.first()) {
    static_cast<void>(work.serve());
    return a;
  }
  const SearchedTasks searched(trained, work, log);
  numerics::RanksProgress progress_of_all(progress, work.threads());
  a.outputs.assign(trained.model().outputs().begin(), trained.model().outputs().end());
  const Eigen::VectorXd noise = stated_noise(study);
  progress.stage(fmt::format("estimating {} parameters from {} tasks", study.unknowns.size(), trained.tasks.size()));
  RouteResult found = by_route(study, searched, noise, log, progress_of_all);
  a.result = found.estimate;
  a.evaluations = std::move(found.evaluations);
  a.resumed = found.resumed;
  a.interrupted = progress.interrupted();
  if (a.interrupted) return a;
  if (!a.result.usable()) throw std::runtime_error(why_diverged(study, trained, a.result));
  a.moment_noise = found.emg.noise;
  a.emg_share = found.emg.input_share;
  a.emg_error_factors = found.emg.error_factors;
  const Eigen::VectorXd standard = start_values(study.unknowns), theta = a.result.best.theta;
  // Those of the whitened outputs are in no unit that a reader knows.
  const std::vector<RowMatrix> predicted = study.emg ? std::vector<RowMatrix>() : a.result.best.predicted;
  a.tasks = outcomes_of(trained, standard, theta, predicted, false, progress.threads());
  for (TaskOutcome& task : outcomes_of(unseen, standard, theta, {}, true, progress.threads()))
    a.tasks.push_back(std::move(task));
  a.unused = std::move(all.unused);
  const std::vector<std::string> wraps = path_warnings(study, trained, theta);
  std::vector<estimation::Evidence> rows = judged(study, trained, a, wraps, noise);
  a.profiles = profiles_of(study, searched, noise, found, progress_of_all);
  a.posterior = posterior_of(study, searched, found, log, progress_of_all);
  work.finish();
  if (study.advice && !progress.interrupted()) a.advice = advice_for(study, *trained.forward, a.result, rows, progress);
  a.interrupted = progress.interrupted();
  if (a.interrupted) return a;
  estimation::ParameterGroup group = judged_group(study.subject.title, std::move(rows));
  group.method = method_of(study);
  group.parameters = judged_parameters(a.result, group.verdict);
  group.reason = reason_of(group, a.tasks);
  group.methods.push_back({group.method, true, a.result.best.message, group.parameters});
  a.predictions = predictions_of(a.tasks, a.outputs);
  a.estimate = estimation::estimate_of(group, widening_of(a.result) * a.result.best.covariance, a.predictions);
  a.estimate.fit = fit_of(a.tasks);
  a.estimate.next_measurements = next_measurements(a.advice);
  for (const std::span<const std::string> more :
       {std::span<const std::string>(found.warnings), std::span<const std::string>(wraps),
        std::span<const std::string>(study.subject.warnings)})
    a.estimate.warnings.insert(a.estimate.warnings.end(), more.begin(), more.end());
  a.identified = estimation::usable(group.verdict) ? with_values(study, group.parameters) : study.subject.written;
  a.groups.push_back(std::move(group));
  return a;
}

MuscleAnalysis validate(const TaskStudy& study, const estimation::Estimate& estimate, Progress& progress) {
  Eigen::VectorXd theta = start_values(study.unknowns);
  std::size_t known = 0;
  for (std::size_t i = 0; i < study.unknowns.size(); ++i) {
    const estimation::Parameter* p = estimate.find(study.unknowns[i].name);
    if (p == nullptr || !std::isfinite(p->value)) continue;
    theta(i) = p->value;
    ++known;
  }
  if (known == 0)
    throw InputError(study.subject.title, "the estimate has no parameter that this study's [[parameter]] names");
  MuscleAnalysis a;
  TaskRecordings all = task_recordings(study, progress);
  a.interrupted = progress.interrupted();
  if (a.interrupted) return a;
  a.preparing_s = all.seconds;
  a.truth = all.truth;
  for (TaskRecording& task : all.tasks) task.hold_out = true;
  const TaskPart unseen = task_part(study, all, true);
  if (unseen.tasks.empty())
    throw InputError(study.subject.title,
                     fmt::format("no task is left to validate on: {}", fmt::join(all.unused, "; ")));
  a.outputs.assign(unseen.model().outputs().begin(), unseen.model().outputs().end());
  progress.stage("validating");
  a.tasks = outcomes_of(unseen, start_values(study.unknowns), theta, {}, true, progress.threads());
  a.unused = std::move(all.unused);
  a.predictions = predictions_of(a.tasks, a.outputs);
  const Eigen::VectorXd noise = stated_noise(study);
  estimation::ParameterGroup group =
      judged_group(study.subject.title, judge_hold_out(a.tasks, noise.size() > 0 ? noise(0) : 0.0, kNaN));
  const bool holds = group.judgement.prediction.grade != estimation::Grade::kNo;
  group.verdict = holds ? estimation::GroupVerdict::kIdentified : estimation::GroupVerdict::kRejected;
  group.reason = fmt::format("{}: {}", holds ? "holds" : "does not hold", estimation::says(group.evidence.front()));
  group.method = estimate.method;
  group.parameters = estimate.parameters;
  a.estimate = estimation::estimate_of(group, estimate.covariance, a.predictions);
  a.estimate.fit = fit_of(a.tasks);
  a.identified = with_values(study, estimate.parameters);
  a.groups.push_back(std::move(group));
  return a;
}

}  // namespace veridyn::muscle
