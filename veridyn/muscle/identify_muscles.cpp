#include "veridyn/muscle/identify_muscles.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/identification/emg_estimate.hpp"
#include "veridyn/muscle/identification/emg_judgement.hpp"
#include "veridyn/muscle/identification/task_posterior.hpp"
#include "veridyn/muscle/identification/task_profiles.hpp"
#include "veridyn/muscle/identification/task_segments.hpp"
#include "veridyn/muscle/identification/task_warnings.hpp"
#include "veridyn/muscle/simulation/wrap_bands.hpp"
#include "veridyn/muscle/task_recordings.hpp"
#include "veridyn/muscle/tasks/task_error.hpp"

namespace veridyn::muscle {
namespace {

using estimation::RowMatrix;

/// The tasks of one use, and the model that estimators see of them.
struct Part {
  std::vector<const TaskRecording*> tasks;
  std::vector<RowMatrix> measured;
  // One of them: tasks that are simulated forward, or along their recorded angles.
  std::unique_ptr<MuscleParametricModel> forward;
  std::unique_ptr<EmgDrivenModel> along;
  std::unique_ptr<estimation::LoggedModel> logged;  // views it

  [[nodiscard]] const estimation::ParametricModel& model() const {
    if (along) return *along;
    return *forward;
  }
};

MuscleModelOptions model_options(const TaskStudy& study) {
  return {.accuracy = study.accuracy, .estimate_start = study.estimate_start, .outputs = study.outputs};
}

/// Those with `hold_out` as given.
Part part_of(const TaskStudy& study, const TaskRecordings& all, bool hold_out, numerics::ValueLog* log = nullptr) {
  Part part;
  std::vector<MotionSegment> forward;
  std::vector<EmgSegment> along;
  for (const TaskRecording& task : all.tasks) {
    if (task.hold_out != hold_out) continue;
    part.tasks.push_back(&task);
    part.measured.push_back(task.measured);
    if (task.forward) forward.push_back(*task.forward);
    if (task.along) along.push_back(*task.along);
  }
  if (part.tasks.empty()) return part;
  const MusculoskeletalSystem& system = *study.subject.system;
  if (study.emg)
    part.along = std::make_unique<EmgDrivenModel>(system, study.unknowns, std::move(along), study.outputs,
                                                  study.emg->signal_of, study.accuracy);
  else
    part.forward =
        std::make_unique<MuscleParametricModel>(system, study.unknowns, std::move(forward), model_options(study));
  const auto nrmse = [tasks = part.tasks](std::size_t segment, const RowMatrix& output) {
    return task_error(tasks[segment]->measured, output).nrmse;
  };
  part.logged = std::make_unique<estimation::LoggedModel>(part.model(), hold_out ? "unseen" : "trained", nrmse, log);
  return part;
}

/// Standard deviations of the outputs' noise; empty unless all are known.
Eigen::VectorXd stated_noise(const TaskStudy& study) {
  Eigen::VectorXd noise(signed_index(study.outputs.size()));
  for (std::size_t j = 0; j < study.outputs.size(); ++j) {
    if (!(study.outputs[j].noise_sd > 0.0)) return {};
    noise(signed_index(j)) = study.outputs[j].noise_sd;
  }
  return noise;
}

/// How a part's tasks go with the standard model and at `theta`; `predicted` in place of simulations where given.
void add_outcomes(const Part& part, const Eigen::VectorXd& standard, const Eigen::VectorXd& theta,
                  const std::vector<RowMatrix>& predicted, bool hold_out, int threads, std::vector<TaskOutcome>& out) {
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
    out.push_back(std::move(task));
  }
}

/// Unseen tasks, output by output.
std::vector<estimation::PredictedQuantity> predictions_of(const MuscleAnalysis& analysis) {
  std::vector<estimation::PredictedQuantity> list;
  for (std::size_t j = 0; j < analysis.outputs.size(); ++j) {
    std::vector<double> measured, predicted;
    double cross = 0.0, squares = 0.0;
    for (const TaskOutcome& t : analysis.tasks) {
      if (!t.hold_out || t.estimated.size() == 0) continue;
      double before = kNaN;
      for (Eigen::Index k = 0; k < t.measured.rows(); ++k) {
        const double z = t.measured(k, signed_index(j)), y = t.estimated(k, signed_index(j));
        if (std::isnan(z)) continue;
        measured.push_back(z);
        predicted.push_back(y);
        squares += (y - z) * (y - z);
        if (!std::isnan(before)) cross += before * (y - z);
        before = y - z;
      }
    }
    if (measured.empty()) continue;
    list.push_back({.name = analysis.outputs[j].name,
                    .unit = analysis.outputs[j].unit,
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
      Muscle& muscle = model.muscles[at(model.muscle(own.muscles[at(name.muscle)].name()))];
      double& value = field_of(muscle.parameters.musculotendon, name.field);
      value = u.factor ? value * p->value : p->value;
    }
  }
  return model;
}

/// What all domains share: the estimate, one group of parameters, predictions.
void fill_analysis(const TaskStudy& study, std::vector<estimation::Evidence> rows, MuscleAnalysis& a) {
  estimation::ParameterGroup group{.name = study.subject.title, .meaning = "muscles"};
  group.evidence = rows;
  group.judgement = estimation::judge(rows);
  group.verdict = estimation::verdict_of(group.judgement);
  a.estimate.subject = study.subject.title;
  a.estimate.method = study.published ? "particle swarm, then pattern search over all tasks"
                      : study.emg     ? "generalised least squares along the recorded angles of all tasks"
                                      : "output error over all tasks";
  a.estimate.evidence = std::move(rows);
  a.estimate.judgement = group.judgement;
  a.predictions = predictions_of(a);
  for (const estimation::PredictedQuantity& q : a.predictions)
    a.estimate.validation[q.name] = {q.fit.mae, q.fit.rmse, q.fit.r2, q.fit.theil, q.unit};
  double nrmse[2] = {0.0, 0.0}, count[2] = {0.0, 0.0};
  for (const TaskOutcome& t : a.tasks) {
    if (!std::isfinite(t.after.nrmse)) continue;
    nrmse[t.hold_out ? 1 : 0] += t.after.nrmse;
    count[t.hold_out ? 1 : 0] += 1.0;
  }
  if (count[0] > 0.0) a.estimate.fit["nrmse_trained"] = nrmse[0] / count[0];
  if (count[1] > 0.0) a.estimate.fit["nrmse_unseen"] = nrmse[1] / count[1];
  a.groups.push_back(std::move(group));
}

void judge_parameters(const TaskStudy& study, MuscleAnalysis& a) {
  estimation::ParameterGroup& group = a.groups.front();
  const TaskEstimate& e = a.result;
  std::vector<std::string> identified;
  for (std::size_t i = 0; i < e.verdicts.size(); ++i)
    if (e.verdicts[i] == TaskVerdict::kIdentified) identified.push_back(e.best.parameters[i].name);
  std::vector<estimation::Parameter> parameters = e.best.parameters;
  // A residual beyond the noise widens what it cannot refuse (Birge 1932).
  if (e.chi_square > 1.0) {
    for (estimation::Parameter& p : parameters) {
      if (p.status == estimation::ParameterStatus::kFixed || !std::isfinite(p.sigma)) continue;
      p.sigma *= std::sqrt(e.chi_square);
      estimation::set_interval(p, std::max(1.0, e.best.degrees_of_freedom));
    }
    a.estimate.covariance *= e.chi_square;
  }
  // Whether an interval is wide is said against the prior here, not against the value.
  for (estimation::Parameter& p : parameters) {
    const bool open =
        p.status == estimation::ParameterStatus::kFixed || p.status == estimation::ParameterStatus::kNotExcited;
    if (open) continue;
    if (group.verdict == estimation::GroupVerdict::kRejected) p.status = estimation::ParameterStatus::kRejected;
    if (group.verdict == estimation::GroupVerdict::kEffective && p.status != estimation::ParameterStatus::kAtBound)
      p.status = estimation::ParameterStatus::kEffective;
  }
  const auto& why = group.judgement.parameters.decided_by;
  const std::string first = why.empty() ? "it could not be judged" : why.front();
  if (group.verdict == estimation::GroupVerdict::kIdentified) {
    group.reason =
        fmt::format("{} of {} parameters identified from {} tasks", identified.size(), e.verdicts.size(),
                    std::count_if(a.tasks.begin(), a.tasks.end(), [](const auto& t) { return !t.hold_out; }));
  } else {
    group.reason = group.verdict == estimation::GroupVerdict::kEffective
                       ? fmt::format("predicts, but its values are no physical constants: {}", first)
                       : fmt::format("rejected: {}", first);
  }
  group.method = a.estimate.method;
  group.parameters = parameters;
  group.methods.push_back({a.estimate.method, true, e.best.message, parameters});
  a.estimate.parameters = std::move(parameters);
  a.estimate.verdict = group.reason;
  a.identified = estimation::usable(group.verdict) ? with_values(study, a.estimate.parameters) : study.subject.written;
}

/// What to perform next, unless something other than too few tasks speaks against the parameters; said in the row about
/// what is determined and in the estimate.
void advise_next(const TaskStudy& study, const MuscleParametricModel& model, const MuscleModelOptions& options,
                 std::vector<estimation::Evidence>& rows, MuscleAnalysis& a, Progress& progress) {
  const auto begun = std::chrono::steady_clock::now();
  const auto determined = std::find_if(rows.begin(), rows.end(), [](const auto& r) { return r.name == kDetermined; });
  for (const estimation::Evidence& row : rows) {
    // More tasks mend these.
    if (row.name == kDetermined || row.name == kDistance || row.outcome != estimation::Outcome::kFailed) continue;
    if (row.bears_on.contains(estimation::Purpose::kParameters)) a.advice.withheld = row.text;
  }
  if (!a.advice.withheld.empty()) return;
  std::vector<int> used;
  for (const Task& task : study.tasks) used.push_back(task.number);
  std::vector<std::string> left_out;
  progress.stage("which further task would tell most");
  const std::vector<PreparedTask> candidates =
      candidate_tasks(*study.subject.system, *study.elbow, used, left_out, progress);
  if (progress.interrupted()) return;
  a.advice = advise_task(*study.subject.system, model, options, a.result, candidates, progress);
  a.advice.left_out.insert(a.advice.left_out.begin(), left_out.begin(), left_out.end());
  a.advice.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  constexpr std::size_t kNamed = 3;
  for (std::size_t i = 0; i < std::min(kNamed, a.advice.tasks.size()); ++i) {
    const AdvisedTask& task = a.advice.tasks[i];
    a.estimate.next_measurements.push_back(
        {task.name, a.advice.now.parameter, a.advice.now.share, task.then.parameter, task.then.share});
  }
  if (a.advice.tasks.empty() || determined == rows.end() || determined->passed()) return;
  const AdvisedTask& best = a.advice.tasks.front();
  determined->advice =
      fmt::format("perform {} next: the widest interval, {}'s, would go from +-{:.2g} to {:.2g} %; or {}", best.name,
                  a.advice.now.parameter, 100.0 * a.advice.now.share, 100.0 * best.then.share, determined->advice);
}

/// By the published search.
TaskEstimate published_estimate(const TaskStudy& study, const Part& part, const Eigen::VectorXd& noise,
                                const numerics::ValueLog* log, MuscleAnalysis& a, Progress& progress) {
  PublishedRouteOptions options = *study.published;
  if (log != nullptr && options.evaluation.log.empty())
    options.evaluation.log = log->path().parent_path() / "search.csv";
  PublishedRouteResult found = published_route(*part.forward, part.measured, options, progress);
  a.evaluations = std::move(found.evaluations);
  a.resumed = found.resumed * part.tasks.size();
  if (found.theta.size() == 0 || progress.interrupted()) {
    TaskEstimate none;
    none.best.message = found.message();
    return none;
  }
  for (std::size_t s = 0; s < found.nrmse.size(); ++s) {
    if (!(found.nrmse[s] <= options.tolerance))
      a.estimate.warnings.push_back(
          fmt::format("the published search ended with an NRMSE of {:.2g} in {}, more than the "
                      "tolerance of {:.2g}: {}",
                      found.nrmse[s], part.tasks[s]->name, options.tolerance, found.pattern.message()));
  }
  TaskSearch search{.steps = static_cast<int>(a.evaluations.size()), .message = found.message()};
  TaskEstimate estimate =
      describe_estimate(*part.logged, part.measured, noise, found.theta, std::move(search), progress);
  estimate.seconds = found.seconds;
  estimate.simulations = {.values = found.simulations};
  return estimate;
}

/// By the route that the study asks for; with EMG `emg` holds what profiles need.
TaskEstimate estimated(const TaskStudy& study, const Part& part, const Eigen::VectorXd& noise,
                       const numerics::ValueLog* log, EmgEstimate& emg, MuscleAnalysis& a, Progress& progress) {
  if (study.published) return published_estimate(study, part, noise, log, a, progress);
  TaskEstimate estimate;
  if (part.along) {
    emg = estimate_from_emg(*part.along, *part.logged, part.measured, noise, study.emg->error, study.search, progress);
    estimate = emg.estimate;
  } else {
    estimate = estimate_from_tasks(*part.logged, part.measured, noise, study.search, progress);
  }
  a.evaluations = part.logged->evaluations();
  a.resumed = part.logged->resumed();
  return estimate;
}

/// Profiles and posterior, where the study asks for them.
void look_around(const TaskStudy& study, const Part& part, const Eigen::VectorXd& noise, const EmgEstimate& emg,
                 numerics::ValueLog* log, MuscleAnalysis& a, Progress& progress) {
  if (!study.profiles.empty()) {
    progress.stage(fmt::format("profile likelihood of {} parameters", study.profiles.size()));
    const Eigen::VectorXd one = Eigen::VectorXd::Ones(signed_index(study.outputs.size()));
    a.profiles = study.emg ? profile_tasks(*emg.model, emg.measured, one, a.result, study.profiles, progress)
                           : profile_tasks(*part.logged, part.measured, noise, a.result, study.profiles, progress);
  }
  if (!study.posterior || progress.interrupted()) return;
  progress.stage(fmt::format("posterior of {} parameters", study.unknowns.size()));
  // The densities are kept, a number each, not the responses.
  a.posterior = study.emg
                    ? sample_tasks(emg.model->on(part.model()), emg.measured, a.result, *study.posterior, progress, log)
                    : sample_tasks(part.model(), part.measured, a.result, *study.posterior, progress, log);
}

/// Why no search came to an end, with the first task's time and state.
std::string why_diverged(const TaskStudy& study, const Part& part, const TaskEstimate& e) {
  std::string text = e.best.message.empty() ? "no search came to an end" : e.best.message;
  Progress silent;
  for (const TaskRecording* task : part.tasks) {
    if (!task->forward) continue;
    const MotionSegment& segment = *task->forward;
    const MuscleTrajectory t = simulate_forward(
        *segment.system, segment.start, segment.drive,
        {.begin = segment.time.front(), .end = segment.time.back(), .accuracy = study.accuracy}, silent);
    if (!t.usable()) return fmt::format("{}; {}: {}", text, segment.name, t.message());
  }
  return text;
}

/// What the paths of the tasks have to be warned of.
std::vector<std::string> path_warnings(const TaskStudy& study, const Part& part, const Eigen::VectorXd& theta) {
  if (part.forward) return task_warnings(*part.forward, theta);
  std::vector<std::string> warnings;
  for (const TaskRecording* task : part.tasks) {
    for (const WrapBandVisit& visit : wrap_band_visits(*study.subject.system, task->time, task->q))
      warnings.push_back(fmt::format("{}: {}", task->name, wrap_band_text(*study.subject.system, visit)));
  }
  return warnings;
}

/// The rows that judge the estimate; those about EMG where the study has it.
std::vector<estimation::Evidence> judged(const TaskStudy& study, const Part& trained, const MuscleAnalysis& a,
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
                                   .outputs = study.outputs}))
    rows.push_back(std::move(row));
  return rows;
}

}  // namespace

MuscleAnalysis identify(const TaskStudy& study, Progress& progress, numerics::ValueLog* log) {
  MuscleAnalysis a;
  TaskRecordings all = task_recordings(study, progress);
  a.interrupted = progress.interrupted();
  if (a.interrupted) return a;
  a.preparing_s = all.seconds;
  a.truth = all.truth;
  const Part trained = part_of(study, all, false, log), unseen = part_of(study, all, true);
  if (trained.tasks.empty())
    throw InputError(study.subject.title,
                     fmt::format("no task is left to estimate from: {}", fmt::join(all.unused, "; ")));
  a.outputs.assign(trained.model().outputs().begin(), trained.model().outputs().end());
  const Eigen::VectorXd noise = stated_noise(study);
  progress.stage(fmt::format("estimating {} parameters from {} tasks", study.unknowns.size(), trained.tasks.size()));
  EmgEstimate emg;
  a.result = estimated(study, trained, noise, log, emg, a, progress);
  a.interrupted = progress.interrupted();
  if (a.interrupted) return a;
  if (!a.result.usable()) throw std::runtime_error(why_diverged(study, trained, a.result));
  a.moment_noise = emg.noise;
  a.emg_share = emg.input_share;
  a.estimate.covariance = a.result.best.covariance;
  const Eigen::VectorXd standard = start_values(study.unknowns), theta = a.result.best.theta;
  // Those of the whitened outputs are in no unit that a reader knows.
  const std::vector<RowMatrix> predicted = study.emg ? std::vector<RowMatrix>() : a.result.best.predicted;
  add_outcomes(trained, standard, theta, predicted, false, progress.threads(), a.tasks);
  if (!unseen.tasks.empty()) add_outcomes(unseen, standard, theta, {}, true, progress.threads(), a.tasks);
  a.unused = std::move(all.unused);
  const std::vector<std::string> wraps = path_warnings(study, trained, theta);
  std::vector<estimation::Evidence> rows = judged(study, trained, a, wraps, noise);
  look_around(study, trained, noise, emg, log, a, progress);
  if (study.advice && !progress.interrupted())
    advise_next(study, *trained.forward, model_options(study), rows, a, progress);
  a.interrupted = progress.interrupted();
  if (a.interrupted) return a;
  fill_analysis(study, std::move(rows), a);
  judge_parameters(study, a);
  for (const std::string& wrap : wraps) a.estimate.warnings.push_back(wrap);
  for (const std::string& warning : study.subject.warnings) a.estimate.warnings.push_back(warning);
  return a;
}

MuscleAnalysis validate(const TaskStudy& study, const estimation::Estimate& estimate, Progress& progress) {
  Eigen::VectorXd theta = start_values(study.unknowns);
  std::size_t known = 0;
  for (std::size_t i = 0; i < study.unknowns.size(); ++i) {
    const estimation::Parameter* p = estimate.find(study.unknowns[i].name);
    if (p == nullptr || !std::isfinite(p->value)) continue;
    theta(signed_index(i)) = p->value;
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
  const Part unseen = part_of(study, all, true);
  if (unseen.tasks.empty())
    throw InputError(study.subject.title,
                     fmt::format("no task is left to validate on: {}", fmt::join(all.unused, "; ")));
  a.outputs.assign(unseen.model().outputs().begin(), unseen.model().outputs().end());
  progress.stage("validating");
  add_outcomes(unseen, start_values(study.unknowns), theta, {}, true, progress.threads(), a.tasks);
  a.unused = std::move(all.unused);
  const Eigen::VectorXd noise = stated_noise(study);
  fill_analysis(study, {judge_hold_out(a.tasks, noise.size() > 0 ? noise(0) : 0.0, kNaN)}, a);
  a.estimate.parameters = estimate.parameters;
  a.estimate.covariance = estimate.covariance;
  a.estimate.method = estimate.method;
  estimation::ParameterGroup& group = a.groups.front();
  const bool holds = group.judgement.prediction.grade != estimation::Grade::kNo;
  group.verdict = holds ? estimation::GroupVerdict::kIdentified : estimation::GroupVerdict::kRejected;
  group.reason = fmt::format("{}: {}", holds ? "holds" : "does not hold", a.estimate.evidence.front().text);
  group.method = estimate.method;
  group.parameters = estimate.parameters;
  a.estimate.verdict = group.reason;
  a.identified = with_values(study, estimate.parameters);
  return a;
}

}  // namespace veridyn::muscle
