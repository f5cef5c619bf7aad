#include "veridyn/muscle/study/muscle_study_tasks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/identification/measured_motion.hpp"
#include "veridyn/muscle/study/muscle_study_parts.hpp"
#include "veridyn/muscle/tasks/elbow_tasks.hpp"

namespace veridyn::muscle {
namespace {

TasksTable read_shared(const StudyTable& table, const MuscleSubject& subject) {
  TasksTable s = TasksTable::keys().read(table);
  const Model& model = subject.system->model();
  for (const auto& [key, name] : {std::pair{"elbow", s.elbow.elbow}, std::pair{"shoulder", s.elbow.shoulder}}) {
    if (table.has(key)) static_cast<void>(internal::coordinate_of(table, key, name, model));
  }
  s.elbow.load = s.load.value_or(subject.loads.empty() ? s.elbow.load : 0.0);
  s.elbow.control.reserve_force = s.reserve_force;
  s.elbow.control.accuracy = s.accuracy;
  return s;
}

/// Numbers of elbow tasks under a key.
std::vector<int> numbers_of(const StudyTable& table, const char* key) {
  std::vector<int> numbers;
  for (const double value : table.numbers(key, "1")) {
    const int number = static_cast<int>(std::clamp(value, -1.0, 1e6));
    if (!(number >= 1 && number <= kElbowTasks) || std::abs(number - value) > 0.0)
      table.fail(key, fmt::format("{:g} is none of the {} tasks; they are counted from 1", value, kElbowTasks));
    if (std::find(numbers.begin(), numbers.end(), number) != numbers.end())
      table.fail(key, fmt::format("has task {} twice", number));
    numbers.push_back(number);
  }
  return numbers;
}

/// Elbow tasks that `[tasks]` names, and which of all it leaves out.
struct ElbowTasks {
  std::vector<Task> tasks;
  std::vector<std::string> notes;
};

ElbowTasks read_elbow_tasks(const StudyTable& table, const ElbowTaskOptions& stated, const Model& model) {
  if (!table.has("numbers") && !table.has("hold_out")) return {};
  ElbowTaskOptions options;
  try {
    options = resolved(model, stated);
  } catch (const InputError& error) {
    const std::string what = error.what();
    table.fail(error.place(), what.substr(std::min(what.size(), error.place().size() + 2)));
  }
  ElbowTasks read;
  const bool all = table.is_text("numbers");
  if (all && table.text("numbers") != "all") table.fail("numbers", "must be numbers of tasks or \"all\"");
  const std::vector<int> held_out = table.has("hold_out") ? numbers_of(table, "hold_out") : std::vector<int>();
  std::vector<int> used = !all && table.has("numbers") ? numbers_of(table, "numbers") : std::vector<int>();
  const auto is_held_out = [&](int n) { return std::find(held_out.begin(), held_out.end(), n) != held_out.end(); };
  for (const int n : used) {
    if (is_held_out(n)) table.fail("hold_out", fmt::format("has task {}, which numbers has too", n));
  }
  for (int n = 1; all && n <= kElbowTasks; ++n) {
    const std::string why = obstacle(model, options, n);
    if (!why.empty()) read.notes.push_back(fmt::format("left out: {}: {}", elbow_task_name(n), why));
    if (why.empty() && !is_held_out(n)) used.push_back(n);
  }
  const auto add = [&](const char* key, const std::vector<int>& numbers, bool hold_out) {
    for (const int n : numbers) {
      if (const std::string why = obstacle(model, options, n); !why.empty())
        table.fail(key, fmt::format("{}: {}", elbow_task_name(n), why));
      read.tasks.push_back(make_elbow_task(model, options, n));
      read.tasks.back().hold_out = hold_out;
    }
  };
  add("numbers", used, false);
  add("hold_out", held_out, true);
  return read;
}

/// The desired motion of `file`; without it one that leaves every coordinate open.
internal::ReadFromFiles<Motion> read_desired_file(const TaskTable& keys, const Model& model) {
  internal::ReadFromFiles<Motion> read{.value = {}};
  read.value.coordinate.resize(model.coordinates.size());
  if (!keys.file) return read;
  read.inputs.push_back(*keys.file);
  const SignalTable signals = read_signals(*keys.file);
  read.value = make_motion(signals, model, {.low_pass_Hz = keys.low_pass_Hz.value_or(0.0)});
  refuse_degrees(signals, model);
  return read;
}

/// Poses of single coordinates: `[task.held]`, `[task.start]`.
std::vector<HeldCoordinate> read_pose(const StudyTable& table, const MuscleSubject& subject) {
  const Model& model = subject.system->model();
  std::vector<HeldCoordinate> pose;
  for (const std::string& key : table.keys()) {
    const std::size_t c = internal::coordinate_of(table, key, key, model);
    internal::check_not_coupled(table, key, c, subject);
    pose.push_back({static_cast<int>(c), internal::coordinate_value(table, key, model.coordinates[c])});
  }
  return pose;
}

bool is_held(std::span<const HeldCoordinate> held, std::size_t c) {
  return std::any_of(held.begin(), held.end(), [&](const HeldCoordinate& h) { return at(h.coordinate) == c; });
}

/// How a task moves: what it began with, its ramps, and rest for all other coordinates.
struct TaskMotion {
  Motion desired;
  double end = 0.0;    ///< of its last ramp, or of what it began with [s]
  bool moves = false;  ///< any coordinate
};

/// @param task with the motion of its file, and with what it holds
TaskMotion read_task_ramps(const StudyTable& table, const MuscleSubject& subject, const Task& task) {
  const Model& model = subject.system->model();
  const Eigen::VectorXd rest = model.default_pose();
  const StudyTable pose = table.table_or_empty("start");
  std::vector<std::vector<Ramp>> ramps(model.coordinates.size());
  std::vector<double> at_rest(rest.begin(), rest.end());
  for (const HeldCoordinate& start : read_pose(pose, subject)) at_rest[start.coordinate] = start.value;
  TaskMotion motion{.desired = task.desired, .end = task.end};
  for (const StudyTable& ramp : table.tables("ramp")) {
    const std::string name = ramp.text("coordinate");
    const std::size_t c = internal::coordinate_of(ramp, "coordinate", name, model);
    internal::check_not_coupled(ramp, "coordinate", c, subject);
    if (task.desired.coordinate[c])
      ramp.fail("coordinate", fmt::format("'{}' is held, or moves by the file, already", name));
    if (subject.system->reduction().role(static_cast<int>(c)) == CoordinateRole::kDriven)
      ramp.fail("coordinate", fmt::format("'{}' is locked and cannot follow a ramp", name));
    ramps[c].push_back(internal::read_ramp(ramp, model.coordinates[c],
                                           {.before = ramps[c].empty() ? nullptr : &ramps[c].back(),
                                            .rest = at_rest[c],
                                            .rest_is_given = pose.has(name),
                                            .rest_key = pose.path(),
                                            .begin = task.begin}));
    motion.end = std::max(motion.end, ramps[c].back().start + ramps[c].back().duration);
  }
  for (std::size_t c = 0; c < model.coordinates.size(); ++c) {
    std::optional<numerics::PiecewisePolynomial>& own = motion.desired.coordinate[c];
    motion.moves = motion.moves || !ramps[c].empty() || (own && !is_held(task.held, c));
    if (!ramps[c].empty()) own = ramp_spline(ramps[c]);
    if (!own && subject.system->reduction().role(static_cast<int>(c)) != CoordinateRole::kCoupled)
      own = resting_spline(at_rest[c]);
  }
  return motion;
}

/// The task with the controls of its `excitation_file`, and their times where nothing else says how long it is.
internal::ReadFromFiles<Task> with_controls(const StudyTable& table, const TaskTable& keys,
                                            const MuscleSubject& subject, const TasksTable& settings, Task task) {
  if (!keys.excitation_file) return {.value = std::move(task)};
  const std::filesystem::path& path = *keys.excitation_file;
  const SignalTable signals = read_signals(path);
  const std::vector<double> least(subject.system->model().muscles.size(), settings.elbow.control.min_control);
  const std::vector<double> reserves(subject.system->coordinates(), settings.reserve_force);
  task.controls = internal::controls_of(signals, *subject.system, least, keys.interpolation, reserves);
  if (!keys.measured && !keys.file && !keys.duration) {
    task.begin = signals.time.front();
    task.end = signals.time.back();
  }
  const double slack = 0.05 * (task.end - task.begin);
  if (!keys.measured && (signals.time.front() > task.begin + slack || signals.time.back() < task.end - slack))
    table.fail("excitation_file", fmt::format("has {:g} .. {:g} s, the task {:g} .. {:g} s", signals.time.front(),
                                              signals.time.back(), task.begin, task.end));
  return {.value = std::move(task), .inputs = {path}};
}

/// The task with what was `measured` of it, at those times.
internal::ReadFromFiles<Task> with_measured(const StudyTable& table, const TaskTable& keys,
                                            const MuscleSubject& subject, std::span<const MuscleOutput> outputs,
                                            Task task) {
  if (!keys.measured) return {.value = std::move(task)};
  if (!task.controls)
    table.fail("measured",
               "needs excitation_file, the controls with which it was performed: those computed for the "
               "standard model are not this person's");
  const std::filesystem::path& path = *keys.measured;
  task.measured = read_measured_motion(read_signals(path), subject.system->model(), outputs);
  const std::vector<double>& time = task.measured->time;
  task.begin = time.front();
  task.end = time.back();
  // Where nothing else says it, the pose is that of the first sample.
  for (std::size_t j = 0; j < outputs.size(); ++j) {
    const double first = task.measured->values(0, j);
    const auto c = at(outputs[j].index);
    if (outputs[j].kind != MuscleOutputKind::kValue || !std::isfinite(first)) continue;
    if (!is_held(task.held, c)) task.desired.coordinate[c] = resting_spline(first);
  }
  const auto covers = task.controls->excitation.times();
  const double step = time.size() > 1 ? time[1] - time[0] : 0.0;
  if (!covers.empty() && covers.size() > 1 && (covers.front() > time.front() + step || covers.back() < time.front()))
    table.fail("measured", fmt::format("begins at {:g} s, its controls are from {:g} to {:g} s: they need one clock",
                                       time.front(), covers.front(), covers.back()));
  return {.value = std::move(task), .inputs = {path}};
}

/// Whether a task is one recorded with EMG; else the study's person performs it, or it is simulated forward.
bool is_recorded(const StudyTable& table, bool emg) {
  const char* const keys[] = {"angles", "moments", "emg"};
  const bool any = std::any_of(std::begin(keys), std::end(keys), [&](const char* key) { return table.has(key); });
  if (!emg) {
    for (const char* key : keys)
      if (table.has(key))
        table.fail(key,
                   "needs [emg]: which electrode is which muscle's, or an empty one where columns have their names");
    return false;
  }
  for (const char* key : {"measured", "excitation_file"}) {
    if (table.has(key))
      table.fail(key,
                 "is of motions that are simulated forward; with [emg] a recorded task has angles, moments and emg");
  }
  for (const char* key : {"file", "ramp", "duration", "load"})
    if (any && table.has(key)) table.fail(key, "and angles exclude each other: the recording says how the task moves");
  return any;
}

/// What all tasks have: name, whether it is held out, settings.
Task started_task(const TaskTable& keys, const ElbowTaskOptions& shared) {
  return {.name = keys.name,
          .begin = 0.0,
          .end = 0.0,
          .rate_Hz = shared.rate_Hz,
          .control = shared.control,
          .hold_out = keys.hold_out};
}

/// Motion in which what is held rests.
Motion holding(Motion motion, std::span<const HeldCoordinate> held) {
  for (const HeldCoordinate& h : held) motion.coordinate[h.coordinate] = resting_spline(h.value);
  return motion;
}

/// A task recorded with EMG.
internal::ReadFromFiles<Task> read_recorded_task(const StudyTable& table, const TaskTable& keys,
                                                 const MuscleSubject& subject, const ElbowTaskOptions& shared,
                                                 std::span<const MuscleOutput> outputs, const EmgSettings& emg) {
  Task task = started_task(keys, shared);
  const Model& model = subject.system->model();
  task.held = read_pose(table.table_or_empty("held"), subject);
  task.desired.coordinate.resize(model.coordinates.size());
  task.desired = holding(std::move(task.desired), task.held);
  Eigen::VectorXd rest = model.default_pose();
  std::vector<char> given(model.coordinates.size(), 0);
  for (const auto& pose : {task.held, read_pose(table.table_or_empty("start"), subject)}) {
    for (const HeldCoordinate& at_rest : pose) {
      rest(at_rest.coordinate) = at_rest.value;
      given[at_rest.coordinate] = 1;
    }
  }
  EmgTask read = read_emg_recording(table, subject, emg, outputs, rest, given);
  task.begin = read.recording.begin;
  task.end = read.end;
  task.recording = std::move(read.recording);
  return {.value = std::move(task), .inputs = std::move(read.inputs), .warnings = std::move(read.notes)};
}

/// A task that is simulated forward.
internal::ReadFromFiles<Task> read_simulated_task(const StudyTable& table, const TaskTable& keys,
                                                  const MuscleSubject& subject, const TasksTable& settings,
                                                  std::span<const MuscleOutput> outputs) {
  Task task = started_task(keys, settings.elbow);
  const Model& model = subject.system->model();
  internal::ReadFromFiles<Motion> file = read_desired_file(keys, model);
  task.begin = file.value.begin;
  task.end = file.value.end;
  task.held = read_pose(table.table_or_empty("held"), subject);
  task.desired = holding(std::move(file.value), task.held);
  if (!task.held.empty()) {
    std::vector<int> free(subject.system->reduction().free().begin(), subject.system->reduction().free().end());
    for (const HeldCoordinate& held : task.held) std::erase(free, held.coordinate);
    if (free.empty()) table.fail("held", "holds every coordinate that could move");
  }
  for (const StudyTable& load : table.tables("load")) task.loads.push_back(internal::read_load(load, model));
  TaskMotion motion = read_task_ramps(table, subject, task);
  task.desired = std::move(motion.desired);
  task.end = motion.end;
  std::vector<std::filesystem::path> inputs = std::move(file.inputs);
  const auto taken = [&](internal::ReadFromFiles<Task> read) {
    inputs.insert(inputs.end(), read.inputs.begin(), read.inputs.end());
    return std::move(read.value);
  };
  task = taken(with_controls(table, keys, subject, settings, std::move(task)));
  task = taken(with_measured(table, keys, subject, outputs, std::move(task)));
  if (!motion.moves && !task.controls)
    table.fail("name",
               fmt::format("= '{}' has no motion: it needs [[task.ramp]], a file or an excitation_file", task.name));
  if (keys.duration && !task.measured) task.end = task.begin + *keys.duration;
  if (keys.duration && task.measured)
    table.fail("duration", "and measured are both given; the recording says how long it is");
  if (!(task.end > task.begin)) table.fail("duration", "is missing: nothing says how long the task is");
  if (!task.measured && (task.end - task.begin) * task.rate_Hz < 2.0)
    table.fail("duration", fmt::format("leaves fewer than two samples at {:g} Hz", task.rate_Hz));
  task.desired.missing.clear();
  task.desired.begin = std::min(task.desired.begin, task.begin);
  task.desired.end = std::max(task.desired.end, task.end);
  return {.value = std::move(task), .inputs = std::move(inputs)};
}

}  // namespace

const KeyTable<TasksTable>& TasksTable::keys() {
  using O = ElbowTaskOptions;
  static const auto elbow =
      KeyTable<O>("tasks")
          .elsewhere(
              {"numbers", "", "1 to 42", "none", "elbow tasks to estimate from; `\"all\"`: those possible", true})
          .elsewhere({"hold_out", "", "1 to 42", "none", "further ones, to validate on", true})
          .text("elbow", &O::elbow, "coordinate that moves")
          .otherwise("the only one with \"elbow\" in its name")
          .text("shoulder", &O::shoulder, "coordinate that is held")
          .otherwise("the only one with \"shoulder\" in its name")
          .text("load_body", &O::load_body, "that carries the load")
          .otherwise("the body that the elbow moves")
          .other({"load_location", "m", "three numbers", "twice as far as its mass centre: the end of a uniform rod",
                  "x, y, z in that body's frame", true},
                 [](const StudyTable& t, const std::string& key, O& o) {
                   const std::vector<double> at = veridyn::internal::numbers_in(t, key, "m", kAnyNumber, 3);
                   o.load_location = Eigen::Vector3d(at[0], at[1], at[2]);
                 })
          .number("start", &O::start, "s", kNotNegative, "the elbow rests before it moves")
          .number("duration", &O::duration, "s", kPositive, "of the movement")
          .number("rate", &O::rate_Hz, "Hz", kPositive, "of samples where nothing is measured")
          .check([](const StudyTable& t, O& o) {
            const double samples = o.rate_Hz * (o.start + o.duration);
            if (!(samples <= 1e6)) t.fail("rate", fmt::format("{:g} Hz makes more than a million samples", o.rate_Hz));
            if (samples < 2.0) t.fail("rate", fmt::format("{:g} Hz leaves fewer than two samples", o.rate_Hz));
          });
  static const auto table =
      KeyTable<TasksTable>("tasks", "What tasks share, and which of the 42 elbow tasks are among them.")
          .with(&TasksTable::elbow, elbow)
          .number("load", &TasksTable::load, "kg", kNotNegative, "in the hand; 0: none")
          .otherwise("1 kg; 0 where the subject has loads")
          .number("accuracy", &TasksTable::accuracy, "1", internal::kAccuracies,
                  "of simulations; for recordings without noise 1e-7")
          .number("reserve_force", &TasksTable::reserve_force, "N m", kNotNegative, "as in `[motion]`")
          .table(
              "control", [](TasksTable& t) -> ControlOptions& { return t.elbow.control; }, internal::control_keys());
  return table;
}

const KeyTable<TaskTable>& TaskTable::keys() {
  using O = TaskTable;
  static const auto table =
      KeyTable<O>("task", "A task of the study's own.")
          .repeated()
          .text("name", &O::name, "for messages and results")
          .required()
          .flag("hold_out", &O::hold_out, "keep it to validate on")
          .number("duration", &O::duration, "s", kPositive, "how long it is")
          .otherwise("to the end of its ramps, file or recording")
          .file("file", &O::file, "the desired motion: `.mot`, `.sto` or `.csv`")
          .number("low_pass", &O::low_pass_Hz, "Hz", kPositive, "cut-off of its samples, without delay")
          .otherwise("none")
          .elsewhere({"ramp", "", "", "", "tables `[[task.ramp]]`, as `[[motion.ramp]]`"})
          .elsewhere({"held", "rad or m", "", "", "a table: `COORDINATE`s that are locked, and where"})
          .elsewhere({"start", "rad or m", "", "the model's pose",
                      "a table: `COORDINATE`s that neither move nor are held", true})
          .elsewhere({"load", "", "", "", "tables `[[task.load]]`, as `[[subject.load]]`, besides those"})
          .file("measured", &O::measured, "the recorded outputs: `.mot`, `.sto` or `.csv`")
          .file("excitation_file", &O::excitation_file, "controls with which it was performed")
          .otherwise("those with which the standard model follows the desired motion")
          .choice("interpolation", &O::interpolation, internal::interpolations(), "as in `[motion]`")
          .elsewhere({"angles", "", "a file", "", "with `[emg]`: columns by coordinate"})
          .elsewhere({"moments", "", "a file", "", "with `[emg]`: outputs, such as `COORDINATE_moment`"})
          .elsewhere({"emg", "", "a file", "", "with `[emg]`: envelopes within 0 .. 1, or in the unit of `maximum`"})
          .check([](const StudyTable& t, O&) {
            if (!t.has("file")) refuse_keys(t, {"low_pass"}, "is of the samples of `file`, and there is none");
            if (!t.has("excitation_file"))
              refuse_keys(t, {"interpolation"}, "is of `excitation_file`, and there is none");
          });
  return table;
}

StudyTasks read_tasks(const StudyTable& root, const MuscleSubject& subject, std::span<const MuscleOutput> outputs,
                      const EmgSettings* emg) {
  StudyTasks out;
  const StudyTable table = root.table_or_empty("tasks");
  const TasksTable settings = read_shared(table, subject);
  out.accuracy = settings.accuracy;
  try {
    out.elbow = resolved(subject.system->model(), settings.elbow);
  } catch (const InputError& error) {
    out.no_elbow = error.what();
  }
  ElbowTasks elbow = read_elbow_tasks(table, settings.elbow, subject.system->model());
  out.tasks = std::move(elbow.tasks);
  out.notes = std::move(elbow.notes);
  for (const StudyTable& own : root.tables("task")) {
    const TaskTable keys = TaskTable::keys().read(own);
    internal::ReadFromFiles<Task> read = is_recorded(own, emg != nullptr)
                                             ? read_recorded_task(own, keys, subject, settings.elbow, outputs, *emg)
                                             : read_simulated_task(own, keys, subject, settings, outputs);
    for (const Task& other : out.tasks) {
      if (other.name == read.value.name) own.fail("name", fmt::format("= '{}' is another task's too", read.value.name));
    }
    out.tasks.push_back(std::move(read.value));
    out.inputs.insert(out.inputs.end(), read.inputs.begin(), read.inputs.end());
    out.notes.insert(out.notes.end(), read.warnings.begin(), read.warnings.end());
  }
  const bool any = std::any_of(out.tasks.begin(), out.tasks.end(), [](const Task& t) { return !t.hold_out; });
  if (!any)
    root.fail("tasks", out.tasks.empty() ? "leave no task: name some with tasks.numbers or [[task]]"
                                         : "leave none to estimate from: all are held out");
  return out;
}

}  // namespace veridyn::muscle
