#include "veridyn/muscle/study/task_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/estimation/uncertainty/profile_choice.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/study/muscle_study_parts.hpp"
#include "veridyn/muscle/study/muscle_study_unknowns.hpp"

namespace veridyn::muscle {
namespace {

/// With EMG the gains of the muscles that have a signal; else F0, L0 and LS of every muscle, `bounds` below and above
/// the model's values, in percent of them.
std::vector<MuscleUnknown> default_unknowns(const Model& model, const std::optional<EmgSettings>& emg, double bounds) {
  std::vector<MuscleUnknown> unknowns;
  for (std::size_t m = 0; emg && m < model.muscles.size(); ++m) {
    if (emg->signal_of[m] >= 0)
      unknowns.push_back(
          make_unknown(model, {.muscles = {model.muscles[m].name()}, .fields = {"excitation_gain"}}, model.name));
  }
  if (emg) return unknowns;
  for (const Muscle& muscle : model.muscles) {
    for (const char* field : {"max_isometric_force", "optimal_fiber_length", "tendon_slack_length"})
      unknowns.push_back(make_unknown(
          model,
          {.muscles = {muscle.name()}, .fields = {field}, .low = Extent{-bounds, true}, .high = Extent{bounds, true}},
          model.name));
  }
  return unknowns;
}

std::vector<MuscleOutput> default_outputs(const MusculoskeletalSystem& system, bool moments) {
  std::vector<MuscleOutput> outputs;
  for (const int c : system.reduction().free()) {
    const auto pairs = system.pairs();
    const auto moves = [&](const auto& pair) {
      return system.reduction().free_root(pair.coordinate) == system.reduction().free_root(c);
    };
    if (!moments || std::any_of(pairs.begin(), pairs.end(), moves))
      outputs.push_back({moments ? MuscleOutputKind::kMoment : MuscleOutputKind::kValue, c, 0.0});
  }
  return outputs;
}

/// How far the EMG of all muscles that have one is ahead of them, within three standard deviations.
MuscleUnknown emg_delay(const Model& model, const EmgSettings& emg) {
  MuscleUnknownSpec spec{.name = "EMG delay", .fields = {"excitation_delay"}, .start = emg.delay_s};
  for (std::size_t m = 0; m < model.muscles.size(); ++m)
    if (emg.signal_of[m] >= 0) spec.muscles.push_back(model.muscles[m].name());
  spec.fixed = !(emg.delay_sigma_s > 0.0);
  const double sigma = spec.fixed ? 1.0 : emg.delay_sigma_s;
  spec.low = Extent{emg.delay_s - 3.0 * sigma};
  spec.high = Extent{emg.delay_s + 3.0 * sigma};
  spec.prior = Extent{sigma};
  return make_unknown(model, spec, model.name);
}

/// `[[parameter]]`, or the default ones within `identify.bounds`; with EMG a delay in any case.
std::vector<MuscleUnknown> unknowns_of(const StudyTable& root, double bounds, const Model& model,
                                       const std::optional<EmgSettings>& emg) {
  const StudyTable identify = root.table_or_empty("identify");
  std::vector<MuscleUnknown> unknowns = read_unknowns(root, model);
  if (emg && identify.has("bounds")) identify.fail("bounds", "is not for [emg]: write [[parameter]] with bounds");
  const bool chosen = !unknowns.empty();
  if (!chosen) unknowns = default_unknowns(model, emg, 100.0 * bounds);
  if (emg && std::ranges::none_of(unknowns, &MuscleUnknown::is_delay)) unknowns.push_back(emg_delay(model, *emg));
  if (!chosen) return unknowns;
  if (identify.has("bounds")) identify.fail("bounds", "is for studies without [[parameter]], where each has its own");
  return unknowns;
}

/// Indices of the outputs of coordinates that some task moves, or that some recording has.
std::vector<Eigen::Index> moving_outputs(std::span<const Task> tasks, std::span<const MuscleOutput> outputs) {
  std::vector<Eigen::Index> moving;
  for (std::size_t j = 0; j < outputs.size(); ++j) {
    const bool moves = std::any_of(tasks.begin(), tasks.end(), [&](const Task& task) {
      if (task.recording) return !task.recording->measured.col(j).array().isNaN().all();
      return std::none_of(task.held.begin(), task.held.end(),
                          [&](const HeldCoordinate& h) { return h.coordinate == outputs[j].index; });
    });
    if (moves) moving.push_back(signed_index(j));
  }
  return moving;
}

/// The task with these columns of what was measured.
Task with_columns(Task task, const std::vector<Eigen::Index>& columns) {
  if (task.measured) task.measured->values = estimation::RowMatrix(task.measured->values(Eigen::all, columns));
  if (task.recording) task.recording->measured = estimation::RowMatrix(task.recording->measured(Eigen::all, columns));
  return task;
}

/// The model of a person who is built otherwise than the study says, prepared as the study's.
std::shared_ptr<const MusculoskeletalSystem> read_body(const StudyTable& table, const TaskStudy& study) {
  if (study.emg) table.fail("model", "is for tasks that are simulated forward, not with [emg]");
  const MusculoskeletalSystem& own = *study.subject.system;
  Model model = OsimFile::load(table.file("model")).model();
  const auto names_of = [](const Model& of) {
    std::vector<std::string> names;
    for (const Coordinate& c : of.coordinates) names.push_back(c.name);
    for (const Muscle& m : of.muscles) names.push_back(m.name());
    return names;
  };
  if (names_of(model) != names_of(own.model()))
    table.fail("model", "has other coordinates or muscles, or in another order, than subject.model");
  for (const HeldLoad& load : study.subject.loads) add_load(model, load.body, load.mass, load.location);
  SystemOptions options{.paths = own.fit() != nullptr ? PathSource::kFitted : PathSource::kExact};
  for (std::size_t c = 0; c < model.coordinates.size(); ++c) {
    model.coordinates[c].locked = own.model().coordinates[c].locked;
    model.coordinates[c].default_value = own.model().coordinates[c].default_value;
  }
  return std::make_shared<const MusculoskeletalSystem>(std::move(model), options);
}

SimulatedPerson read_person(const StudyTable& table, const TaskStudy& study) {
  SimulatedPerson person = SimulatedPerson::keys().read(table);
  if (table.has("model")) person.body = read_body(table, study);
  for (const char* key : {"moment_noise", "emg_noise"})
    if (!study.emg && table.has(key)) table.fail(key, "needs [emg]");
  const StudyTable values = table.table_or_empty("parameters");
  std::vector<std::string> names;
  for (const MuscleUnknown& u : study.unknowns) names.push_back(u.name);
  for (const std::string& key : values.keys()) {
    const auto found = std::find(names.begin(), names.end(), key);
    if (found == names.end()) values.fail(key, fmt::format("is no unknown of this study{}", suggestion(key, names)));
    const MuscleUnknown& u = study.unknowns[found - names.begin()];
    const double value = values.number(key, u.unit);
    if (!(value >= u.low && value <= u.high))
      values.fail(key, fmt::format("{:g} is outside the bounds {:g} .. {:g}, where no search would find it", value,
                                   u.low, u.high));
    person.values[key] = value;
  }
  for (std::size_t i = 0; i < study.tasks.size(); ++i) {
    if (study.tasks[i].measured || study.tasks[i].recording)
      table.fail("", fmt::format("and task '{}' with a recording exclude each other", study.tasks[i].name));
  }
  return person;
}

/// Names of the unknowns that are estimated.
std::vector<std::string> free_unknowns(const std::vector<MuscleUnknown>& unknowns) {
  std::vector<std::string> free;
  for (const MuscleUnknown& u : unknowns)
    if (!u.fixed) free.push_back(u.name);
  return free;
}

/// `route`; nothing where it is the gradient's.
std::optional<PublishedRouteOptions> read_route(const StudyTable& table, const MuscleIdentifyTable& keys,
                                                const TaskStudy& study) {
  if (!keys.published) return std::nullopt;
  if (study.emg) table.fail("route", "= \"published\" simulates tasks forward; with [emg] it is \"gradient\"");
  PublishedRouteOptions route{.tolerance = keys.tolerance};
  route.swarm.seed = route.pattern.seed = study.seed;
  route.evaluation.max_evaluations = keys.evaluations;
  route.evaluation.log = keys.log;
  if (study.estimate_start)
    table.fail("route",
               "= \"published\" does not find where motions begin: estimate_start = false, or the gradient route");
  return route;
}

/// `posterior = true`, or a table with options.
std::optional<estimation::EnsembleOptions> read_posterior(const StudyTable& table, const TaskStudy& study) {
  estimation::EnsembleOptions options{.seed = study.seed};
  if (!table.is_table("posterior")) return table.flag_or("posterior", false) ? std::optional(options) : std::nullopt;
  const StudyTable t = table.table("posterior");
  posterior_keys().read(t, options);
  try {
    options.validate(static_cast<std::size_t>(
        std::count_if(study.unknowns.begin(), study.unknowns.end(), [](const MuscleUnknown& u) { return !u.fixed; })));
  } catch (const InputError& error) {
    const std::string what = error.what();
    t.fail(error.place(), what.substr(std::min(what.size(), error.place().size() + 2)));
  }
  return options;
}

bool read_estimate_start(const StudyTable& table, const MuscleIdentifyTable& keys, const TaskStudy& study) {
  const bool estimate = keys.estimate_start.value_or(!study.person && !study.emg);
  if (estimate && study.emg)
    table.fail("estimate_start", "has no meaning with [emg]: the angles are those of the recording from the beginning");
  return estimate;
}

/// @param no_elbow why the model has no elbow tasks
bool read_advice(const StudyTable& table, const MuscleIdentifyTable& keys, const TaskStudy& study,
                 const std::string& no_elbow) {
  const bool recorded = std::any_of(study.tasks.begin(), study.tasks.end(), [](const Task& t) { return !!t.controls; });
  const bool advice = keys.advice.value_or(study.elbow && !recorded && !study.emg);
  if (advice && study.emg)
    table.fail("advice", "has no meaning with [emg]: the EMG of a task that was not performed is not known");
  if (advice && !study.elbow) table.fail("advice", fmt::format("needs the elbow tasks: {}", no_elbow));
  return advice;
}

void check_emg_outputs(const StudyTable& root, const Model& model, const std::vector<MuscleOutput>& outputs) {
  const std::vector<StudyTable> tables = root.tables("output");
  for (std::size_t i = 0; i < outputs.size() && i < tables.size(); ++i) {
    if (outputs[i].kind == MuscleOutputKind::kValue || outputs[i].kind == MuscleOutputKind::kSpeed)
      tables[i].fail("name", fmt::format("= '{}' is an angle, which is given with [emg]: outputs are "
                                         "COORDINATE.moment, MUSCLE.fiber_length, MUSCLE.tendon_force",
                                         output_name(model, outputs[i])));
  }
}

}  // namespace

const KeyTable<SimulatedPerson>& SimulatedPerson::keys() {
  using P = SimulatedPerson;
  static const auto table =
      KeyTable<P>("person", "A simulated person in place of recordings, to see what the tasks would determine.")
          .number("spread", &P::spread, "1", internal::kBelowOne,
                  "hidden parameters are within so much of the model's, uniform, by the seed")
          .elsewhere({"parameters", "", "", "none", "a table: hidden values of single unknowns by their names", true})
          .number("noise", &P::noise, "rad", kNotNegative,
                  "of measured angles (positions: m); of other outputs that of `[[output]]`")
          .number("noise_correlation", &P::noise_correlation_s, "s", kNotNegative,
                  "correlation time of that noise, of first order; 0: white")
          .number("moment_noise", &P::moment_noise, "N m", kNotNegative,
                  "with `[emg]`: of measured moments without a noise in `[[output]]`")
          .number("emg_noise", &P::emg_noise, "1", internal::kBelowOne, "with `[emg]`: of the EMG over its value")
          .otherwise("as `emg.noise`")
          .choice("muscles", &P::millard, {{"as the model", false}, {"millard", true}},
                  "of another class than the model's, to see what is said of a wrong model")
          .elsewhere({"model", "", "a file", "the subject's",
                      "bodies, joints and paths of another model with the same coordinates and muscles, likewise",
                      true})
          .number("load_factor", &P::load_factor, "1", kPositive, "true loads over the stated ones, likewise");
  return table;
}

const KeyTable<MuscleIdentifyTable>& MuscleIdentifyTable::keys() {
  using O = MuscleIdentifyTable;
  static const auto search =
      KeyTable<TaskEstimateOptions>("identify")
          .count("starts", &TaskEstimateOptions::starts, 1, 1000, "searches")
          .count("screened", &TaskEstimateOptions::screened, 1, 100000,
                 "points whose fit is looked at to choose where they begin; at least `starts`")
          .check([](const StudyTable& t, TaskEstimateOptions& o) {
            if (!t.has("screened")) o.screened = std::max(o.screened, o.starts);
            if (o.screened < o.starts)
              t.fail("screened", fmt::format("= {} must be from starts = {} to 100000", o.screened, o.starts));
          });
  static const auto table =
      KeyTable<O>("identify", "How muscles are estimated from tasks.")
          .number("bounds", &O::bounds, "1", between(0.0, 1.0),
                  "of the unknowns, below and above the model's values, where the study has no `[[parameter]]`")
          .with(&O::search, search)
          .flag("estimate_start", &O::estimate_start, "pose and speed where each task begins are unknown too")
          .otherwise("`true` with recordings that are simulated forward")
          .flag("advice", &O::advice, "say which further elbow task would narrow the widest interval most")
          .otherwise("`true`; `false` where controls or EMG are recorded")
          .elsewhere({"profiles", "", "names, `true`, `false`", "false",
                      "parameters whose profile likelihood is followed; `true`: all that are not fixed"})
          .elsewhere({"posterior", "", "`true`, `false`, a table", "false", "draw samples of the posterior"})
          .choice("route", &O::published, {{"gradient", false}, {"published", true}},
                  "`gradient`: least squares with exact sensitivities; `published`: particle swarms, then pattern "
                  "search, by values only")
          .number("tolerance", &O::tolerance, "1", kPositive, "published: greatest NRMSE of a task")
          .count("evaluations", &O::evaluations, 1, 1'000'000'000,
                 "published: most evaluations; each simulates all tasks")
          .file("log", &O::log, "published: keeps every evaluation; a log that is there is continued")
          .check([](const StudyTable& t, O& o) {
            for (const char* key : {"tolerance", "evaluations", "log"})
              if (!o.published && t.has(key)) t.fail(key, "needs route = \"published\"");
          });
  return table;
}

const KeyTable<estimation::EnsembleOptions>& posterior_keys() {
  using O = estimation::EnsembleOptions;
  static const auto table =
      KeyTable<O>("identify.posterior")
          .count("walkers", &O::walkers, 6, 1'000'000, "of the ensemble; even, at least twice the unknowns")
          .otherwise("32, or twice the unknowns and two")
          .count("steps", &O::steps, 20, 10'000'000, "of every walker, at most")
          .count("effective", &O::effective, 1, 1'000'000'000, "independent draws wanted of each parameter");
  return table;
}

bool has_tasks(const StudyTable& root) {
  const std::vector<std::string> keys = root.keys();
  return std::any_of(keys.begin(), keys.end(), [](const std::string& k) { return k == "task" || k == "tasks"; });
}

TaskStudy read_task_study(const Study& source, Progress& progress) {
  const StudyTable& root = source.root();
  TaskStudy study;
  study.seed = static_cast<std::uint64_t>(root.integer_or("seed", 1));
  if (!has_tasks(root))
    root.fail("tasks", "is missing: muscles are estimated from tasks; `veridyn simulate` runs a [motion]");
  study.subject = internal::read_subject(root, progress);
  const MusculoskeletalSystem& system = *study.subject.system;
  const StudyTable identify = root.table_or_empty("identify");
  const MuscleIdentifyTable keys = MuscleIdentifyTable::keys().read(identify);
  if (system.path_source() == PathSource::kAsOpenSim)
    root.table("subject").fail("paths", "= \"opensim\" has no derivatives; take \"exact\" or \"fitted\"");
  if (root.is_table("emg")) study.emg = read_emg(root.table("emg"), system.model());
  study.unknowns = with_bound_priors(unknowns_of(root, keys.bounds, system.model(), study.emg));
  if (std::all_of(study.unknowns.begin(), study.unknowns.end(), [](const MuscleUnknown& u) { return u.fixed; }))
    root.fail("parameter", "leaves nothing to estimate: all are fixed");
  study.outputs = read_outputs(root, system.model());
  const bool chosen = !study.outputs.empty();
  if (!chosen) study.outputs = default_outputs(system, study.emg.has_value());
  if (study.emg) check_emg_outputs(root, system.model(), study.outputs);
  StudyTasks tasks = read_tasks(root, study.subject, study.outputs, study.emg ? &*study.emg : nullptr);
  study.tasks = std::move(tasks.tasks);
  study.accuracy = tasks.accuracy;
  study.notes = std::move(tasks.notes);
  study.elbow = tasks.elbow;
  study.inputs = study.subject.inputs;
  study.inputs.insert(study.inputs.end(), tasks.inputs.begin(), tasks.inputs.end());
  if (!chosen) {
    const std::vector<Eigen::Index> moving = moving_outputs(study.tasks, study.outputs);
    std::vector<MuscleOutput> outputs;
    for (const Eigen::Index j : moving) outputs.push_back(study.outputs[j]);
    study.outputs = std::move(outputs);
    for (Task& task : study.tasks) task = with_columns(std::move(task), moving);
  }
  if (root.is_table("person")) {
    const StudyTable person = root.table("person");
    study.person = read_person(person, study);
    if (person.has("model")) study.inputs.push_back(person.file("model"));
    for (MuscleOutput& output : study.outputs)
      if ((!chosen || study.emg) && output.noise_sd == 0.0)
        output.noise_sd = study.emg ? study.person->moment_noise : study.person->noise;
  }
  for (const Task& task : study.tasks) {
    if (!study.person && !task.measured && !task.recording)
      root.fail("task", fmt::format("'{}' has no recording ({}), and there is no [person] to simulate one", task.name,
                                    study.emg ? "angles, moments and emg" : "measured = \"trial.mot\""));
  }
  study.search = keys.search;
  study.search.seed = study.seed;
  study.estimate_start = read_estimate_start(identify, keys, study);
  study.profiles = estimation::read_profiles(identify, free_unknowns(study.unknowns));
  study.posterior = read_posterior(identify, study);
  study.advice = read_advice(identify, keys, study, tasks.no_elbow);
  study.published = read_route(identify, keys, study);
  for (const char* other : {"motion", "sensitivity"})
    if (root.is_table(other)) root.accept(other);
  root.finish();
  return study;
}

}  // namespace veridyn::muscle
