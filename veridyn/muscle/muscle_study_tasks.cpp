#include "veridyn/muscle/muscle_study_tasks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/identification/measured_motion.hpp"
#include "veridyn/muscle/muscle_study_parts.hpp"
#include "veridyn/muscle/tasks/elbow_tasks.hpp"

namespace veridyn::muscle {
namespace {

/// What [tasks] says for all of them.
struct SharedSettings {
  ElbowTaskOptions elbow;
  double reserve_force = 1.0;
};

SharedSettings read_shared(const StudyTable& table, const MuscleStudy& subject, StudyTasks& out) {
  SharedSettings s;
  s.elbow.elbow = table.text_or("elbow", "");
  s.elbow.shoulder = table.text_or("shoulder", "");
  const Model& model = subject.system->model();
  for (const char* key : {"elbow", "shoulder"}) {
    if (table.has(key)) static_cast<void>(internal::coordinate_of(table, key, table.text(key), model));
  }
  s.elbow.load = table.number_or("load", "kg", subject.loads.empty() ? s.elbow.load : 0.0);
  if (!(s.elbow.load >= 0.0)) table.fail("load", fmt::format("{:g} kg must be >= 0", s.elbow.load));
  s.elbow.load_body = table.text_or("load_body", "");
  if (table.has("load_location")) {
    const std::vector<double> location = table.numbers("load_location", "m");
    if (location.size() != 3)
      table.fail("load_location", fmt::format("has {} numbers, expected x, y, z", location.size()));
    s.elbow.load_location = Eigen::Vector3d(location[0], location[1], location[2]);
  }
  s.elbow.start = table.number_or("start", "s", s.elbow.start);
  if (!(s.elbow.start >= 0.0)) table.fail("start", fmt::format("{:g} s must be >= 0", s.elbow.start));
  s.elbow.duration = table.positive_or("duration", "s", s.elbow.duration);
  s.elbow.rate_Hz = table.positive_or("rate", "1/s", s.elbow.rate_Hz);
  if (!(s.elbow.rate_Hz * (s.elbow.start + s.elbow.duration) <= 1e6))
    table.fail("rate", fmt::format("{:g} Hz makes more than a million samples", s.elbow.rate_Hz));
  if (s.elbow.rate_Hz * (s.elbow.start + s.elbow.duration) < 2.0)
    table.fail("rate", fmt::format("{:g} Hz leaves fewer than two samples", s.elbow.rate_Hz));
  out.accuracy = table.positive_or("accuracy", "1", out.accuracy);
  if (!(out.accuracy >= 1e-13 && out.accuracy <= 0.1))
    table.fail("accuracy", fmt::format("{:g} must be from 1e-13 to 0.1", out.accuracy));
  s.reserve_force = table.number_or("reserve_force", "N m", s.reserve_force);
  if (!(s.reserve_force >= 0.0)) table.fail("reserve_force", fmt::format("{:g} must be >= 0", s.reserve_force));
  s.elbow.control = internal::read_control_options(table.table_or_empty("control"));
  s.elbow.control.reserve_force = s.reserve_force;
  s.elbow.control.accuracy = out.accuracy;
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

void add_elbow_tasks(const StudyTable& table, SharedSettings settings, const MuscleStudy& subject, StudyTasks& out) {
  const Model& model = subject.system->model();
  const bool any = table.has("numbers") || table.has("hold_out");
  if (!any) return;
  try {
    settings.elbow = resolved(model, settings.elbow);
  } catch (const InputError& error) {
    const std::string what = error.what();
    table.fail(error.place(), what.substr(std::min(what.size(), error.place().size() + 2)));
  }
  const bool all = table.is_text("numbers");
  if (all && table.text("numbers") != "all") table.fail("numbers", "must be numbers of tasks or \"all\"");
  const std::vector<int> held_out = table.has("hold_out") ? numbers_of(table, "hold_out") : std::vector<int>();
  std::vector<int> used = !all && table.has("numbers") ? numbers_of(table, "numbers") : std::vector<int>();
  const auto is_held_out = [&](int n) { return std::find(held_out.begin(), held_out.end(), n) != held_out.end(); };
  for (const int n : used) {
    if (is_held_out(n)) table.fail("hold_out", fmt::format("has task {}, which numbers has too", n));
  }
  for (int n = 1; all && n <= kElbowTasks; ++n) {
    const std::string why = obstacle(model, settings.elbow, n);
    if (!why.empty()) out.notes.push_back(fmt::format("left out: {}: {}", elbow_task_name(n), why));
    if (why.empty() && !is_held_out(n)) used.push_back(n);
  }
  const auto add = [&](const char* key, const std::vector<int>& numbers, bool hold_out) {
    for (const int n : numbers) {
      if (const std::string why = obstacle(model, settings.elbow, n); !why.empty())
        table.fail(key, fmt::format("{}: {}", elbow_task_name(n), why));
      out.tasks.push_back(make_elbow_task(model, settings.elbow, n));
      out.tasks.back().hold_out = hold_out;
    }
  };
  add("numbers", used, false);
  add("hold_out", held_out, true);
}

/// The desired motion of a file, as far as the table names one.
void read_desired_file(const StudyTable& table, const Model& model, Task& task, StudyTasks& out) {
  if (!table.has("file")) return;
  MotionOptions options;
  if (table.has("low_pass")) options.low_pass_Hz = table.positive("low_pass", "1/s");
  const std::filesystem::path path = table.file("file");
  const SignalTable signals = read_signals(path);
  task.desired = make_motion(signals, model, options);
  refuse_degrees(signals, model);
  task.begin = task.desired.begin;
  task.end = task.desired.end;
  out.inputs.push_back(path);
}

void read_held(const StudyTable& table, const MuscleStudy& subject, Task& task) {
  const Model& model = subject.system->model();
  for (const std::string& key : table.keys()) {
    const std::size_t c = internal::coordinate_of(table, key, key, model);
    internal::check_not_coupled(table, key, c, subject);
    const double value = internal::coordinate_value(table, key, model.coordinates[c]);
    task.held.push_back({static_cast<int>(c), value});
    task.desired.coordinate[c] = resting_spline(value);
  }
}

/// Ramps, and rest for what neither moves nor is held. Whether anything moves.
bool read_task_ramps(const StudyTable& table, const MuscleStudy& subject, Task& task) {
  const Model& model = subject.system->model();
  const Eigen::VectorXd rest = model.default_pose();
  const StudyTable pose = table.table_or_empty("start");
  std::vector<std::vector<Ramp>> ramps(model.coordinates.size());
  std::vector<double> at_rest(rest.begin(), rest.end());
  for (const std::string& key : pose.keys()) {
    const std::size_t c = internal::coordinate_of(pose, key, key, model);
    internal::check_not_coupled(pose, key, c, subject);
    at_rest[c] = internal::coordinate_value(pose, key, model.coordinates[c]);
  }
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
    task.end = std::max(task.end, ramps[c].back().start + ramps[c].back().duration);
  }
  bool moves = false;
  for (std::size_t c = 0; c < model.coordinates.size(); ++c) {
    const bool held =
        std::any_of(task.held.begin(), task.held.end(), [&](const auto& h) { return at(h.coordinate) == c; });
    moves = moves || !ramps[c].empty() || (task.desired.coordinate[c] && !held);
    if (!ramps[c].empty()) task.desired.coordinate[c] = ramp_spline(ramps[c]);
    if (!task.desired.coordinate[c] &&
        subject.system->reduction().role(static_cast<int>(c)) != CoordinateRole::kCoupled)
      task.desired.coordinate[c] = resting_spline(at_rest[c]);
  }
  return moves;
}

/// `measured` and `excitation_file`.
void read_recording(const StudyTable& table, const MuscleStudy& subject, const SharedSettings& settings,
                    std::span<const MuscleOutput> outputs, Task& task, StudyTasks& out) {
  const Model& model = subject.system->model();
  if (table.has("excitation_file")) {
    const std::filesystem::path path = table.file("excitation_file");
    const SignalTable signals = read_signals(path);
    const std::vector<double> least(model.muscles.size(), settings.elbow.control.min_control);
    task.controls = internal::controls_of(signals, *subject.system, least, internal::read_interpolation(table),
                                          settings.reserve_force);
    if (!table.has("measured") && !table.has("file") && !table.has("duration")) {
      task.begin = signals.time.front();
      task.end = signals.time.back();
    }
    const double slack = 0.05 * (task.end - task.begin);
    if (!table.has("measured") && (signals.time.front() > task.begin + slack || signals.time.back() < task.end - slack))
      table.fail("excitation_file", fmt::format("has {:g} .. {:g} s, the task {:g} .. {:g} s", signals.time.front(),
                                                signals.time.back(), task.begin, task.end));
    out.inputs.push_back(path);
  }
  if (!table.has("measured")) return;
  if (!task.controls)
    table.fail("measured",
               "needs excitation_file, the controls with which it was performed: those computed for the "
               "standard model are not this person's");
  const std::filesystem::path path = table.file("measured");
  task.measured = read_measured_motion(read_signals(path), model, outputs);
  out.inputs.push_back(path);
  const std::vector<double>& time = task.measured->time;
  task.begin = time.front();
  task.end = time.back();
  // Where nothing else says it, the pose is that of the first sample.
  for (std::size_t j = 0; j < outputs.size(); ++j) {
    const double first = task.measured->values(0, signed_index(j));
    const auto c = at(outputs[j].index);
    if (outputs[j].kind != MuscleOutputKind::kValue || !std::isfinite(first)) continue;
    const bool held =
        std::any_of(task.held.begin(), task.held.end(), [&](const auto& h) { return at(h.coordinate) == c; });
    if (!held) task.desired.coordinate[c] = resting_spline(first);
  }
  const auto covers = task.controls->excitation.times();
  const double step = time.size() > 1 ? time[1] - time[0] : 0.0;
  if (!covers.empty() && covers.size() > 1 && (covers.front() > time.front() + step || covers.back() < time.front()))
    table.fail("measured", fmt::format("begins at {:g} s, its controls are from {:g} to {:g} s: they need one clock",
                                       time.front(), covers.front(), covers.back()));
}

/// A task recorded with EMG, or nothing where the study's person performs it.
bool read_recorded(const StudyTable& table, const MuscleStudy& subject, std::span<const MuscleOutput> outputs,
                   const EmgSettings* emg, Task& task, StudyTasks& out) {
  const char* const keys[] = {"angles", "moments", "emg"};
  const bool any = std::any_of(std::begin(keys), std::end(keys), [&](const char* key) { return table.has(key); });
  if (emg == nullptr) {
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
  if (!any) return false;
  for (const char* key : {"file", "ramp", "duration", "load"})
    if (table.has(key)) table.fail(key, "and angles exclude each other: the recording says how the task moves");
  read_held(table.table_or_empty("held"), subject, task);
  const Model& model = subject.system->model();
  Eigen::VectorXd rest = model.default_pose();
  std::vector<char> given(model.coordinates.size(), 0);
  for (const HeldCoordinate& held : task.held) {
    rest(held.coordinate) = held.value;
    given[at(held.coordinate)] = 1;
  }
  const StudyTable pose = table.table_or_empty("start");
  for (const std::string& key : pose.keys()) {
    const std::size_t c = internal::coordinate_of(pose, key, key, model);
    internal::check_not_coupled(pose, key, c, subject);
    rest(signed_index(c)) = internal::coordinate_value(pose, key, model.coordinates[c]);
    given[c] = 1;
  }
  read_emg_recording(table, subject, *emg, outputs, rest, given, task, out.inputs, out.notes);
  return true;
}

Task read_task(const StudyTable& table, const MuscleStudy& subject, const SharedSettings& settings,
               std::span<const MuscleOutput> outputs, const EmgSettings* emg, StudyTasks& out) {
  Task task{.name = table.text("name")};
  task.hold_out = table.flag_or("hold_out", false);
  task.begin = task.end = 0.0;
  task.rate_Hz = settings.elbow.rate_Hz;
  task.control = settings.elbow.control;
  const Model& model = subject.system->model();
  task.desired.coordinate.resize(model.coordinates.size());
  if (read_recorded(table, subject, outputs, emg, task, out)) return task;
  read_desired_file(table, model, task, out);
  read_held(table.table_or_empty("held"), subject, task);
  if (!task.held.empty()) {
    std::vector<int> free(subject.system->reduction().free().begin(), subject.system->reduction().free().end());
    for (const HeldCoordinate& held : task.held) std::erase(free, held.coordinate);
    if (free.empty()) table.fail("held", "holds every coordinate that could move");
  }
  for (const StudyTable& load : table.tables("load")) task.loads.push_back(internal::read_load(load, model));
  const bool moves = read_task_ramps(table, subject, task);
  read_recording(table, subject, settings, outputs, task, out);
  if (!moves && !task.controls)
    table.fail("name",
               fmt::format("= '{}' has no motion: it needs [[task.ramp]], a file or an excitation_file", task.name));
  if (table.has("duration") && !task.measured) task.end = task.begin + table.positive("duration", "s");
  if (table.has("duration") && task.measured)
    table.fail("duration", "and measured are both given; the recording says how long it is");
  if (!(task.end > task.begin)) table.fail("duration", "is missing: nothing says how long the task is");
  if (!task.measured && (task.end - task.begin) * task.rate_Hz < 2.0)
    table.fail("duration", fmt::format("leaves fewer than two samples at {:g} Hz", task.rate_Hz));
  task.desired.missing.clear();
  task.desired.begin = std::min(task.desired.begin, task.begin);
  task.desired.end = std::max(task.desired.end, task.end);
  return task;
}

}  // namespace

StudyTasks read_tasks(const StudyTable& root, const MuscleStudy& subject, std::span<const MuscleOutput> outputs,
                      const EmgSettings* emg) {
  StudyTasks out;
  const StudyTable table = root.table_or_empty("tasks");
  const SharedSettings settings = read_shared(table, subject, out);
  try {
    out.elbow = resolved(subject.system->model(), settings.elbow);
  } catch (const InputError& error) {
    out.no_elbow = error.what();
  }
  add_elbow_tasks(table, settings, subject, out);
  for (const StudyTable& own : root.tables("task")) {
    Task task = read_task(own, subject, settings, outputs, emg, out);
    for (const Task& other : out.tasks) {
      if (other.name == task.name) own.fail("name", fmt::format("= '{}' is another task's too", task.name));
    }
    out.tasks.push_back(std::move(task));
  }
  const bool any = std::any_of(out.tasks.begin(), out.tasks.end(), [](const Task& t) { return !t.hold_out; });
  if (!any)
    root.fail("tasks", out.tasks.empty() ? "leave no task: name some with tasks.numbers or [[task]]"
                                         : "leave none to estimate from: all are held out");
  return out;
}

}  // namespace veridyn::muscle
