#include "veridyn/muscle/identify_muscles.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/identification/task_profiles.hpp"
#include "veridyn/muscle/identification/task_segments.hpp"
#include "veridyn/muscle/identification/task_warnings.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::muscle {
namespace {

using estimation::RowMatrix;

/// The tasks of a study with what was measured, those that can be used.
struct MeasuredTasks {
  std::vector<PreparedTask> tasks;
  std::vector<RowMatrix> measured;
  std::vector<std::string> unused;
  std::map<std::string, double, std::less<>> truth;
  double seconds = 0.0;
};

Eigen::VectorXd start_values(const std::vector<MuscleUnknown>& unknowns) {
  Eigen::VectorXd theta(signed_index(unknowns.size()));
  for (std::size_t i = 0; i < unknowns.size(); ++i) theta(signed_index(i)) = unknowns[i].start;
  return theta;
}

/// Hidden values, drawn unknown by unknown.
Eigen::VectorXd hidden_values(const TaskStudy& study) {
  Eigen::VectorXd theta = start_values(study.unknowns);
  for (std::size_t i = 0; i < study.unknowns.size(); ++i) {
    const MuscleUnknown& u = study.unknowns[i];
    numerics::RandomStream random(study.seed, "hidden " + u.name);
    const double drawn = u.start * (1.0 + study.person->spread * random.uniform(-1.0, 1.0));
    if (u.fixed) continue;
    const auto set = study.person->values.find(u.name);
    theta(signed_index(i)) = set != study.person->values.end() ? set->second : std::clamp(drawn, u.low, u.high);
  }
  return theta;
}

/// A person's system in a task: true muscles and loads along the model's paths.
std::shared_ptr<const MusculoskeletalSystem> person_system(const TaskStudy& study, const PreparedTask& task) {
  SystemChanges changes{.loads = task.task.loads};
  for (HeldLoad& load : changes.loads) load.mass *= study.person->load_factor;
  const Model& model = study.subject.system->model();
  for (const HeldCoordinate& held : task.task.held)
    changes.locked.push_back(model.coordinates[at(held.coordinate)].name);
  changes.muscles = muscle_parameters(model);
  for (MuscleParameters& muscle : changes.muscles) {
    if (!study.person->millard) continue;
    muscle.curves = MillardCurves{};
    muscle.fiber_damping = 0.1;
  }
  return std::make_shared<const MusculoskeletalSystem>(*study.subject.system, changes);
}

double noise_of(const TaskStudy& study, const MuscleOutput& output) {
  return output.kind == MuscleOutputKind::kValue ? study.person->noise : output.noise_sd;
}

void simulate_person(const TaskStudy& study, MeasuredTasks& out, const Progress& progress) {
  const Eigen::VectorXd hidden = hidden_values(study);
  for (std::size_t i = 0; i < study.unknowns.size(); ++i) out.truth[study.unknowns[i].name] = hidden(signed_index(i));
  std::vector<std::shared_ptr<const MusculoskeletalSystem>> systems;
  std::vector<MotionSegment> segments = segments_of(out.tasks);
  for (std::size_t s = 0; s < segments.size(); ++s) {
    systems.push_back(person_system(study, out.tasks[s]));
    segments[s].system = systems.back().get();
  }
  const MuscleParametricModel person(*study.subject.system, study.unknowns, std::move(segments),
                                     {.accuracy = study.accuracy, .outputs = study.outputs});
  out.measured = simulate_tasks(person, hidden, progress.threads());
  for (std::size_t s = 0; s < out.measured.size(); ++s) {
    numerics::RandomStream random(study.seed, "noise of " + out.tasks[s].task.name);
    for (Eigen::Index k = 0; k < out.measured[s].rows(); ++k) {
      for (std::size_t j = 0; j < study.outputs.size(); ++j)
        out.measured[s](k, signed_index(j)) += noise_of(study, study.outputs[j]) * random.normal();
    }
  }
}

void drop_unusable(MeasuredTasks& out) {
  std::vector<PreparedTask> tasks;
  std::vector<RowMatrix> measured;
  for (std::size_t i = 0; i < out.tasks.size(); ++i) {
    const bool has_motion = out.measured.empty() || out.measured[i].size() > 0;
    if (out.tasks[i].usable() && has_motion) {
      tasks.push_back(std::move(out.tasks[i]));
      if (!out.measured.empty()) measured.push_back(std::move(out.measured[i]));
      continue;
    }
    out.unused.push_back(fmt::format("{}: {}", out.tasks[i].task.name,
                                     has_motion ? out.tasks[i].trouble : "the simulated person cannot perform it"));
  }
  out.tasks = std::move(tasks);
  out.measured = std::move(measured);
}

MeasuredTasks measured_tasks(const TaskStudy& study, Progress& progress) {
  const auto begun = std::chrono::steady_clock::now();
  MeasuredTasks out;
  progress.stage(fmt::format("controls of {} tasks", study.tasks.size()));
  out.tasks = prepare_tasks(*study.subject.system, study.tasks, progress);
  if (progress.interrupted()) return out;
  drop_unusable(out);
  if (study.person) {
    simulate_person(study, out, progress);
    drop_unusable(out);
  } else {
    for (const PreparedTask& task : out.tasks) out.measured.push_back(task.task.measured->values);
  }
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return out;
}

/// Those with `hold_out` as given: segments and measurements.
struct Part {
  std::vector<const PreparedTask*> tasks;
  std::vector<MotionSegment> segments;
  std::vector<RowMatrix> measured;
};
Part part_of(const MeasuredTasks& all, bool hold_out) {
  Part part;
  for (std::size_t i = 0; i < all.tasks.size(); ++i) {
    if (all.tasks[i].task.hold_out != hold_out) continue;
    part.tasks.push_back(&all.tasks[i]);
    part.segments.push_back(segment_of(all.tasks[i]));
    part.measured.push_back(all.measured[i]);
  }
  return part;
}

/// How a part's tasks go with the standard model and at `theta`; `predicted` in place of simulations where given.
void add_outcomes(const MuscleParametricModel& model, const Part& part, const Eigen::VectorXd& standard,
                  const Eigen::VectorXd& theta, const std::vector<RowMatrix>& predicted, bool hold_out, int threads,
                  std::vector<TaskOutcome>& out) {
  std::vector<RowMatrix> before = simulate_tasks(model, standard, threads);
  std::vector<RowMatrix> after = predicted.empty() ? simulate_tasks(model, theta, threads) : predicted;
  for (std::size_t s = 0; s < part.tasks.size(); ++s) {
    TaskOutcome task{.name = part.tasks[s]->task.name, .hold_out = hold_out, .time = part.tasks[s]->time};
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
  a.estimate.method =
      study.published ? "particle swarm, then pattern search over all tasks" : "output error over all tasks";
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
    if (row.name == kDetermined || row.outcome != estimation::Outcome::kFailed) continue;
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

/// By the route that the study asks for.
TaskEstimate estimated(const TaskStudy& study, const MuscleParametricModel& model,
                       const std::vector<RowMatrix>& measured, const Eigen::VectorXd& noise, Progress& progress) {
  if (!study.published) return estimate_from_tasks(model, measured, noise, study.search, progress);
  const PublishedRouteResult found = published_route(model, measured, *study.published, progress);
  if (found.theta.size() == 0 || progress.interrupted()) {
    TaskEstimate none;
    none.best.message = found.message();
    return none;
  }
  TaskSearch search{.steps = static_cast<int>(found.evaluations), .message = found.message()};
  TaskEstimate estimate = describe_estimate(model, measured, noise, found.theta, std::move(search), progress);
  estimate.seconds = found.seconds;
  return estimate;
}

/// Why no search came to an end, with the first task's time and state.
std::string why_diverged(const TaskStudy& study, const Part& part, const TaskEstimate& e) {
  std::string text = e.best.message.empty() ? "no search came to an end" : e.best.message;
  Progress silent;
  for (std::size_t s = 0; s < part.segments.size(); ++s) {
    const MotionSegment& segment = part.segments[s];
    const MuscleTrajectory t = simulate_forward(
        *segment.system, segment.start, segment.drive,
        {.begin = segment.time.front(), .end = segment.time.back(), .accuracy = study.accuracy}, silent);
    if (!t.usable()) return fmt::format("{}; {}: {}", text, segment.name, t.message());
  }
  return text;
}

}  // namespace

MuscleAnalysis identify(const TaskStudy& study, Progress& progress) {
  MuscleAnalysis a;
  MeasuredTasks all = measured_tasks(study, progress);
  a.interrupted = progress.interrupted();
  if (a.interrupted) return a;
  a.preparing_s = all.seconds;
  a.truth = all.truth;
  const Part trained = part_of(all, false), unseen = part_of(all, true);
  if (trained.tasks.empty())
    throw InputError(study.subject.title,
                     fmt::format("no task is left to estimate from: {}", fmt::join(all.unused, "; ")));
  const MuscleModelOptions options{
      .accuracy = study.accuracy, .estimate_start = study.estimate_start, .outputs = study.outputs};
  const MuscleParametricModel model(*study.subject.system, study.unknowns, trained.segments, options);
  a.outputs.assign(model.outputs().begin(), model.outputs().end());
  const Eigen::VectorXd noise = model.output_noise();
  progress.stage(fmt::format("estimating {} parameters from {} tasks", study.unknowns.size(), trained.tasks.size()));
  a.result = estimated(study, model, trained.measured, noise, progress);
  a.interrupted = progress.interrupted();
  if (a.interrupted) return a;
  if (!a.result.usable()) throw std::runtime_error(why_diverged(study, trained, a.result));
  a.estimate.covariance = a.result.best.covariance;
  const Eigen::VectorXd standard = start_values(study.unknowns), theta = a.result.best.theta;
  add_outcomes(model, trained, standard, theta, a.result.best.predicted, false, progress.threads(), a.tasks);
  if (!unseen.tasks.empty()) {
    const MuscleParametricModel other(*study.subject.system, study.unknowns, unseen.segments, options);
    add_outcomes(other, unseen, standard, theta, {}, true, progress.threads(), a.tasks);
  }
  a.unused = std::move(all.unused);
  const std::vector<std::string> wraps = task_warnings(model, theta);
  std::vector<estimation::Evidence> rows = judge_tasks({.model = model,
                                                        .estimate = a.result,
                                                        .tasks = a.tasks,
                                                        .unused = a.unused,
                                                        .wrap_warnings = wraps,
                                                        .noise_known = noise.size() > 0,
                                                        .noise = noise.size() > 0 ? noise(0) : 0.0,
                                                        .simulated = study.person.has_value()});
  if (!study.profiles.empty()) {
    progress.stage(fmt::format("profile likelihood of {} parameters", study.profiles.size()));
    a.profiles = profile_tasks(model, trained.measured, noise, a.result, study.profiles, progress);
  }
  if (study.advice && !progress.interrupted()) advise_next(study, model, options, rows, a, progress);
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
  MeasuredTasks all = measured_tasks(study, progress);
  a.interrupted = progress.interrupted();
  if (a.interrupted) return a;
  a.preparing_s = all.seconds;
  a.truth = all.truth;
  for (PreparedTask& task : all.tasks) task.task.hold_out = true;
  const Part unseen = part_of(all, true);
  if (unseen.tasks.empty())
    throw InputError(study.subject.title,
                     fmt::format("no task is left to validate on: {}", fmt::join(all.unused, "; ")));
  const MuscleParametricModel model(
      *study.subject.system, study.unknowns, unseen.segments,
      {.accuracy = study.accuracy, .estimate_start = study.estimate_start, .outputs = study.outputs});
  a.outputs.assign(model.outputs().begin(), model.outputs().end());
  progress.stage("validating");
  add_outcomes(model, unseen, start_values(study.unknowns), theta, {}, true, progress.threads(), a.tasks);
  a.unused = std::move(all.unused);
  const Eigen::VectorXd noise = model.output_noise();
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
