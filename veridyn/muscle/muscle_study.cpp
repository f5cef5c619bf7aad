#include "veridyn/muscle/muscle_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "veridyn/core/nearest.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/model/ramp.hpp"

namespace veridyn::muscle {
namespace {

std::vector<std::string> muscle_names(const Model& model) {
  std::vector<std::string> names;
  for (const Muscle& m : model.muscles) names.push_back(m.name());
  return names;
}

std::vector<std::string> coordinate_names(const Model& model) {
  std::vector<std::string> names;
  for (const Coordinate& c : model.coordinates) names.push_back(c.name);
  return names;
}

/// Index of a muscle that the key of a table names.
std::size_t muscle_of(const StudyTable& table, const std::string& key, const std::string& name, const Model& model) {
  const int index = model.muscle(name);
  if (index < 0) {
    table.fail(key,
               fmt::format("model '{}' has no muscle '{}'{}", model.name, name, suggestion(name, muscle_names(model))));
  }
  return static_cast<std::size_t>(index);
}

std::size_t coordinate_of(const StudyTable& table, const std::string& key, const std::string& name,
                          const Model& model) {
  const int index = model.coordinate(name);
  if (index < 0) {
    table.fail(key, fmt::format("model '{}' has no coordinate '{}'{}", model.name, name,
                                suggestion(name, coordinate_names(model))));
  }
  return static_cast<std::size_t>(index);
}

/// The value of a coordinate, inside its range.
double coordinate_value(const StudyTable& table, const std::string& key, const Coordinate& c) {
  const double value = table.number(key, c.unit());
  const double slack = 1e-6 * (1.0 + c.high - c.low);
  if (value < c.low - slack || value > c.high + slack) {
    table.fail(key, fmt::format("{:.6g} {} is outside the range of '{}', {:.6g} .. {:.6g}", value, c.unit(), c.name,
                                c.low, c.high));
  }
  return value;
}

double excitation(const StudyTable& table, const std::string& key) {
  const double value = table.number(key, "1");
  if (!(value >= 0.0 && value <= 1.0)) table.fail(key, fmt::format("{} must be from 0 to 1", value));
  return value;
}

std::string known_parameters() {
  std::string text;
  for (const MusculotendonField& p : kMusculotendonFields)
    text += fmt::format("{}{}", text.empty() ? "" : ", ", p.name);
  return text;
}

void set_parameter(const StudyTable& table, const std::string& key, const std::string& muscle,
                   const std::string& parameter, Model& model, std::vector<ParameterChange>& changes) {
  Muscle& m = model.muscles[muscle_of(table, key, muscle, model)];
  const auto found = std::find_if(kMusculotendonFields.begin(), kMusculotendonFields.end(),
                                  [&](const MusculotendonField& p) { return p.name == parameter; });
  if (found == kMusculotendonFields.end()) {
    std::vector<std::string> names;
    for (const MusculotendonField& p : kMusculotendonFields) names.emplace_back(p.name);
    table.fail(key, fmt::format("a muscle has no parameter '{}'{}", parameter, suggestion(parameter, names)));
  }
  double& value = field_of(m.parameters.musculotendon, static_cast<std::size_t>(found - kMusculotendonFields.begin()));
  const double before = value;
  if (std::string_view(found->unit) == "rad") {
    value = table.number(key, "rad");
    if (!(value >= 0.0 && value < 1.5)) table.fail(key, fmt::format("{:g} rad must be from 0 to 1.5 rad", value));
  } else {
    value = table.positive(key, found->unit);
  }
  changes.push_back({muscle, parameter, before, value});
}

void read_parameters(const StudyTable& table, Model& model, std::vector<ParameterChange>& changes) {
  for (const std::string& key : table.keys()) {
    if (table.is_table(key)) {  // BIClong.optimal_fiber_length without quotes
      const StudyTable muscle = table.table(key);
      for (const std::string& parameter : muscle.keys())
        set_parameter(muscle, parameter, key, parameter, model, changes);
      continue;
    }
    const std::size_t dot = key.rfind('.');
    if (dot == std::string::npos) {
      table.fail(key, fmt::format("is not MUSCLE.PARAMETER with a parameter of {}", known_parameters()));
    }
    set_parameter(table, key, key.substr(0, dot), key.substr(dot + 1), model, changes);
  }
}

HeldLoad read_load(const StudyTable& table, const Model& model) {
  HeldLoad load;
  load.body = table.text("body");
  const int body = model.body(load.body);
  if (body <= 0) {
    std::vector<std::string> names;
    for (std::size_t i = 1; i < model.bodies.size(); ++i) names.push_back(model.bodies[i].name);
    table.fail("body", fmt::format("= '{}' is no body of model '{}' that could carry a load{}", load.body, model.name,
                                   suggestion(load.body, names)));
  }
  load.mass = table.positive("mass", "kg");
  if (table.has("location")) {
    const std::vector<double> at = table.numbers("location", "m");
    if (at.size() != 3) table.fail("location", fmt::format("has {} numbers, expected x, y, z", at.size()));
    load.location = Eigen::Vector3d(at[0], at[1], at[2]);
  }
  return load;
}

std::vector<std::string> coordinate_list(const StudyTable& table, const std::string& key, const Model& model) {
  if (!table.has(key)) return {};
  std::vector<std::string> names = table.texts(key);
  for (const std::string& name : names) static_cast<void>(coordinate_of(table, key, name, model));
  return names;
}

void read_subject(const StudyTable& subject, MuscleStudy& study) {
  study.model_name = subject.text("model");
  const bool file = study.model_name.find('.') != std::string::npos || study.model_name.find('/') != std::string::npos;
  if (file) {
    const std::filesystem::path path = subject.file("model");
    study.file.emplace(OsimFile::load(path));
    study.inputs.push_back(path);
  } else {
    std::vector<std::string> names;
    for (const EmbeddedText& model : builtin_models()) names.emplace_back(model.name);
    if (std::find(names.begin(), names.end(), study.model_name) == names.end()) {
      subject.fail("model", fmt::format("= '{}' is no built-in model{}; a file ends in .osim", study.model_name,
                                        suggestion(study.model_name, names)));
    }
    study.file.emplace(load_model(study.model_name));
  }
  study.written = study.file->model();
  read_parameters(subject.table_or_empty("parameters"), study.written, study.changes);
  Model model = study.written;
  for (const StudyTable& table : subject.tables("load")) {
    study.loads.push_back(read_load(table, model));
    const HeldLoad& load = study.loads.back();
    add_load(model, load.body, load.mass, load.location);
  }
  SystemOptions options;
  const std::vector<std::string> sources = {"exact", "fitted", "opensim"};
  const std::string source = subject.choice_or("paths", sources, "exact");
  options.paths = source == "exact"    ? PathSource::kExact
                  : source == "fitted" ? PathSource::kFitted
                                       : PathSource::kAsOpenSim;
  options.locked = coordinate_list(subject, "locked", model);
  options.unlocked = coordinate_list(subject, "unlocked", model);
  for (const std::string& name : options.unlocked) {
    if (std::find(options.locked.begin(), options.locked.end(), name) != options.locked.end())
      subject.fail("unlocked", fmt::format("names '{}', which subject.locked names too", name));
  }
  options.without_unsupported = subject.flag_or("without_unsupported", false);
  study.system = std::make_unique<MusculoskeletalSystem>(std::move(model), options);
  if (study.system->reduction().free().empty())
    subject.fail("locked", "leaves no coordinate that could move: all are locked or coupled");
}

/// Beginning, duration, and the motion of a file where there is one.
void read_times(const StudyTable& motion, MuscleStudy& study) {
  const bool file = study.method != MuscleMethod::kForward && motion.has("file");
  if (file) {
    const std::filesystem::path path = motion.file("file");
    MotionOptions options;
    if (motion.has("low_pass")) options.low_pass_Hz = motion.positive("low_pass", "1/s");
    const SignalTable table = read_signals(path);
    study.motion = make_motion(table, study.system->model(), options);
    study.inputs.push_back(path);
    for (const std::string& name : study.motion.beyond_range)
      study.warnings.push_back(fmt::format("the wished '{}' leaves its range", name));
    for (const int c : study.system->reduction().driven()) {
      if (study.method == MuscleMethod::kComputedMuscleControl && study.motion.coordinate[static_cast<std::size_t>(c)])
        study.warnings.push_back(fmt::format("'{}' is locked: it is held where the motion has it at the beginning",
                                             study.system->model().coordinates[static_cast<std::size_t>(c)].name));
    }
  }
  study.begin = motion.number_or("begin", "s", file ? study.motion.begin : 0.0);
  study.end = study.begin + motion.positive_or("duration", "s", file ? study.motion.end - study.begin : 1.0);
  if (file && !(study.end > study.begin)) {
    motion.fail("begin",
                fmt::format("{:g} s is at or after the end of the motion, {:g} s", study.begin, study.motion.end));
  }
  const double slack = 1e-9 * (1.0 + std::abs(study.end));
  if (file && (study.begin < study.motion.begin - slack || study.end > study.motion.end + slack)) {
    motion.fail(motion.has("duration") ? "duration" : "begin",
                fmt::format("asks for {:g} .. {:g} s, the file has {:g} .. {:g} s", study.begin, study.end,
                            study.motion.begin, study.motion.end));
  }
  if (study.end - study.begin > 3600.0)
    motion.fail("duration", fmt::format("{:g} s is more than an hour", study.end - study.begin));
  study.rate_Hz = motion.positive_or("rate", "1/s", study.rate_Hz);
  if (!(study.rate_Hz * (study.end - study.begin) <= 1e7)) {
    motion.fail("rate", fmt::format("{:g} Hz makes more than 10 million rows", study.rate_Hz));
  }
  study.accuracy = motion.positive_or("accuracy", "1", study.accuracy);
  if (!(study.accuracy >= 1e-13 && study.accuracy <= 0.1))
    motion.fail("accuracy", fmt::format("{:g} must be from 1e-13 to 0.1", study.accuracy));
  study.reserve_force = motion.number_or("reserve_force", "N m", study.reserve_force);
  if (!(study.reserve_force >= 0.0))
    motion.fail("reserve_force", fmt::format("{:g} must be >= 0", study.reserve_force));
}

void check_not_coupled(const StudyTable& table, const std::string& key, std::size_t c, const MuscleStudy& study) {
  if (study.system->reduction().role(static_cast<int>(c)) == CoordinateRole::kCoupled) {
    table.fail(key, fmt::format("'{}' follows another coordinate through a coupler; set that one",
                                study.system->model().coordinates[c].name));
  }
}

void read_start(const StudyTable& motion, MuscleStudy& study) {
  const Model& model = study.system->model();
  study.start = default_start(model);
  const StudyTable pose = motion.table_or_empty("start");
  for (const std::string& key : pose.keys()) {
    const std::size_t c = coordinate_of(pose, key, key, model);
    check_not_coupled(pose, key, c, study);
    study.start.q(static_cast<Eigen::Index>(c)) = coordinate_value(pose, key, model.coordinates[c]);
    if (study.method != MuscleMethod::kForward && study.motion.coordinate[c])
      pose.fail(key, "and motion.file both say where it is");
  }
  if (study.method != MuscleMethod::kForward) return;
  const StudyTable speed = motion.table_or_empty("start_speed");
  for (const std::string& key : speed.keys()) {
    const std::size_t c = coordinate_of(speed, key, key, model);
    check_not_coupled(speed, key, c, study);
    study.start.qdot(static_cast<Eigen::Index>(c)) = speed.number(key, model.coordinates[c].unit() + "/s");
  }
}

/// Where a column stands at a time: the sample, or between two on their line.
double value_at(const SignalTable& table, int column, double time) {
  const std::vector<double>& t = table.time;
  const std::vector<double>& v = table.values[static_cast<std::size_t>(column)];
  const auto after = static_cast<std::size_t>(std::upper_bound(t.begin(), t.end(), time) - t.begin());
  if (after == 0) return v.front();
  if (after == t.size() || t[after - 1] == time) return v[after - 1];
  return v[after - 1] + (time - t[after - 1]) / (t[after] - t[after - 1]) * (v[after] - v[after - 1]);
}

/// The column "/jointset/.../name/suffix", or "name/suffix", "name.suffix", "name_suffix"; of values also "name".
int state_column(const SignalTable& table, std::string_view name, std::string_view suffix) {
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const std::string_view column = table.names[i];
    if (suffix == "value" && column == name) return static_cast<int>(i);
    for (const char separator : {'/', '.', '_'}) {
      const std::string wanted = fmt::format("{}{}{}", name, separator, suffix);
      if (column == wanted || column.ends_with("/" + wanted)) return static_cast<int>(i);
    }
  }
  return -1;
}

/// States as `simulate` and OpenSim write them.
void read_start_file(const StudyTable& motion, MuscleStudy& study) {
  if (!motion.has("start_file")) return;
  const Model& model = study.system->model();
  const std::filesystem::path path = motion.file("start_file");
  const SignalTable table = read_signals(path);
  study.inputs.push_back(path);
  const double slack = 1e-9 * (1.0 + std::abs(study.begin));
  if (study.begin < table.time.front() - slack || study.begin > table.time.back() + slack) {
    motion.fail("start_file", fmt::format("has no state at {:g} s, only from {:g} to {:g} s", study.begin,
                                          table.time.front(), table.time.back()));
  }
  const auto value = [&](const std::string& name, std::string_view suffix, double otherwise) {
    const int column = state_column(table, name, suffix);
    return column < 0 ? otherwise : value_at(table, column, study.begin);
  };
  const auto muscles = static_cast<Eigen::Index>(model.muscles.size());
  bool any = false;
  for (std::size_t c = 0; c < model.coordinates.size(); ++c) {
    const Coordinate& coordinate = model.coordinates[c];
    const auto i = static_cast<Eigen::Index>(c);
    const bool degrees = table.rotations_in_degrees && coordinate.motion == CoordinateMotion::kRotational;
    const double unit = degrees ? std::numbers::pi / 180.0 : 1.0;
    any = any || state_column(table, coordinate.name, "value") >= 0;
    study.start.q(i) = unit * value(coordinate.name, "value", study.start.q(i) / unit);
    study.start.qdot(i) = unit * value(coordinate.name, "speed", study.start.qdot(i) / unit);
  }
  if (!any) motion.fail("start_file", fmt::format("{} has no column of a coordinate's value", path.string()));
  Eigen::VectorXd activation(muscles), fiber(muscles);
  bool all = true;
  for (Eigen::Index m = 0; m < muscles; ++m) {
    const MuscleParameters& p = model.muscles[static_cast<std::size_t>(m)].parameters;
    activation(m) = value(p.name, "activation", std::nan(""));
    fiber(m) = value(p.name, "fiber_length", std::nan(""));
    const bool needs_activation = !p.ignore_activation_dynamics, needs_fiber = !p.rigid_tendon;
    if (!needs_activation) activation(m) = 0.0;
    if (!needs_fiber) fiber(m) = p.musculotendon.optimal_fiber_length;
    if (std::isnan(activation(m)) != std::isnan(fiber(m)) && needs_activation && needs_fiber)
      motion.fail("start_file", fmt::format("has only one of activation and fiber_length of '{}'", p.name));
    all = all && !std::isnan(activation(m)) && !std::isnan(fiber(m));
  }
  if (all) {
    study.start.activation = activation;
    study.start.fiber_length = fiber;
  } else {
    study.warnings.push_back(fmt::format(
        "{} does not have activation and fibre length of every muscle: muscles start at rest", path.string()));
  }
}

/// Rows that repeat the one before hold nothing new; each would be an end of a step.
ControlSignals without_repeats(const ControlSignals& signals) {
  if (signals.interpolation() != Interpolation::kHold || signals.times().empty()) return signals;
  std::vector<double> time, values;
  for (std::size_t i = 0; i < signals.times().size(); ++i) {
    const std::span<const double> row = signals.row(i);
    if (i > 0 && std::equal(row.begin(), row.end(), signals.row(i - 1).begin())) continue;
    time.push_back(signals.times()[i]);
    values.insert(values.end(), row.begin(), row.end());
  }
  return {std::move(time), std::move(values), signals.size(), Interpolation::kHold};
}

/// Generalised forces from columns COORDINATE_reserve.
ControlSignals read_reserves(const SignalTable& table, const MuscleStudy& study, Interpolation interpolation) {
  const Model& model = study.system->model();
  const std::size_t n = model.coordinates.size();
  std::vector<double> values(table.time.size() * n, 0.0);
  bool any = false;
  for (const int c : study.system->reduction().free()) {
    const auto i = static_cast<std::size_t>(c);
    const int column = table.find(model.coordinates[i].name + "_reserve", "control");
    if (column < 0) continue;
    any = true;
    for (std::size_t k = 0; k < table.time.size(); ++k)
      values[k * n + i] = study.reserve_force * table.values[static_cast<std::size_t>(column)][k];
  }
  if (!any) return {};
  return without_repeats({table.time, std::move(values), n, interpolation});
}

void read_excitations(const StudyTable& motion, MuscleStudy& study) {
  const Model& model = study.system->model();
  const StudyTable table = motion.table_or_empty("excitation");
  std::vector<double> now(model.muscles.size(), table.has("default") ? excitation(table, "default") : 0.05);
  for (const std::string& key : table.keys()) {
    if (key == "default") continue;
    now[muscle_of(table, key, key, model)] = excitation(table, key);
  }
  const std::vector<std::string> kinds = {"linear", "hold"};
  const std::vector<StudyTable> steps = motion.tables("excitation_step");
  if (motion.has("excitation_file")) {
    if (!steps.empty()) motion.fail("excitation_step", "and motion.excitation_file exclude each other");
    const Interpolation interpolation =
        motion.choice_or("interpolation", kinds, "linear") == "hold" ? Interpolation::kHold : Interpolation::kLinear;
    const std::filesystem::path path = motion.file("excitation_file");
    const SignalTable signals = read_signals(path);
    study.inputs.push_back(path);
    study.drive.excitation = without_repeats(make_excitations(signals, model, now, interpolation));
    study.drive.reserve = read_reserves(signals, study, interpolation);
    return;
  }
  std::vector<double> times{study.begin}, values = now;
  for (const StudyTable& step : steps) {
    const double time = step.number("time", "s");
    if (!(time > times.back())) {
      step.fail("time",
                fmt::format("{:g} s is not after {:g} s, where the excitations before it begin", time, times.back()));
    }
    if (step.has("default")) std::fill(now.begin(), now.end(), excitation(step, "default"));
    for (const std::string& key : step.keys()) {
      if (key != "time" && key != "default") now[muscle_of(step, key, key, model)] = excitation(step, key);
    }
    times.push_back(time);
    values.insert(values.end(), now.begin(), now.end());
  }
  study.drive.excitation = {std::move(times), std::move(values), now.size(), Interpolation::kHold};
}

void read_ramps(const StudyTable& motion, MuscleStudy& study) {
  const Model& model = study.system->model();
  const std::vector<std::string> shapes = {"minimum jerk", "half sine", "linear"};
  const StudyTable pose = motion.table_or_empty("start");
  std::vector<std::vector<Ramp>> ramps(model.coordinates.size());
  for (const StudyTable& table : motion.tables("ramp")) {
    const std::string name = table.text("coordinate");
    const std::size_t c = coordinate_of(table, "coordinate", name, model);
    const Coordinate& coordinate = model.coordinates[c];
    check_not_coupled(table, "coordinate", c, study);
    if (study.motion.coordinate[c]) table.fail("coordinate", fmt::format("'{}' has its motion from motion.file", name));
    if (study.method == MuscleMethod::kComputedMuscleControl &&
        study.system->reduction().role(static_cast<int>(c)) == CoordinateRole::kDriven) {
      table.fail("coordinate", fmt::format("'{}' is locked and cannot follow a ramp; motion.start sets it", name));
    }
    Ramp ramp;
    const Ramp* before = ramps[c].empty() ? nullptr : &ramps[c].back();
    ramp.from = before != nullptr ? before->to : study.start.q(static_cast<Eigen::Index>(c));
    if (table.has("from")) {
      const double from = coordinate_value(table, "from", coordinate);
      if ((before != nullptr || pose.has(name)) && std::abs(from - ramp.from) > 1e-9) {
        table.fail("from", fmt::format("{:.6g} {} jumps: {} it is at {:.6g}", from, coordinate.unit(),
                                       before != nullptr ? "after the ramp before" : "by motion.start", ramp.from));
      }
      ramp.from = from;
    }
    ramp.to = coordinate_value(table, "to", coordinate);
    ramp.start = table.number_or("start", "s", before != nullptr ? before->start + before->duration : study.begin);
    ramp.duration = table.positive("duration", "s");
    if (before != nullptr && !(ramp.start >= before->start + before->duration - 1e-12)) {
      table.fail("start", fmt::format("{:g} s is before the end of the ramp before, {:g} s", ramp.start,
                                      before->start + before->duration));
    }
    if (before != nullptr) ramp.start = std::max(ramp.start, before->start + before->duration);
    const std::string shape = table.choice_or("shape", shapes, "minimum jerk");
    ramp.shape = shape == "half sine" ? RampShape::kHalfSine
                 : shape == "linear"  ? RampShape::kLinear
                                      : RampShape::kMinimumJerk;
    ramps[c].push_back(ramp);
  }
  for (std::size_t c = 0; c < ramps.size(); ++c) {
    if (!ramps[c].empty()) study.motion.coordinate[c] = ramp_spline(ramps[c]);
  }
}

/// The wish: file, ramps, and rest for all others.
void read_wish(const StudyTable& motion, MuscleStudy& study) {
  const Model& model = study.system->model();
  read_ramps(motion, study);
  for (std::size_t c = 0; c < model.coordinates.size(); ++c) {
    if (study.system->reduction().role(static_cast<int>(c)) == CoordinateRole::kCoupled) continue;
    if (study.motion.coordinate[c]) {
      study.wished.push_back(model.coordinates[c].name);
    } else {
      study.motion.coordinate[c] = resting_spline(study.start.q(static_cast<Eigen::Index>(c)));
    }
  }
  if (study.wished.empty()) {
    motion.fail("", fmt::format("method = \"{}\" needs a motion: file = \"x.mot\" or [[motion.ramp]]",
                                method_name(study.method)));
  }
  study.motion.missing.clear();
  study.motion.begin = std::min(study.motion.begin, study.begin);
  study.motion.end = std::max(study.motion.end, study.end);
}

void read_control(const StudyTable& table, MuscleStudy& study) {
  ControlOptions& o = study.control;
  o.window = table.positive_or("window", "s", o.window);
  if (study.method == MuscleMethod::kComputedMuscleControl && !(o.window <= study.end - study.begin)) {
    table.fail("window", fmt::format("{:g} s is longer than the motion, {:g} s", o.window, study.end - study.begin));
  }
  o.kp = table.number_or("kp", "1/s^2", o.kp);
  o.kv = table.number_or("kv", "1/s", o.kv);
  if (!(o.kp >= 0.0)) table.fail("kp", fmt::format("{:g} must be >= 0", o.kp));
  if (!(o.kv >= 0.0)) table.fail("kv", fmt::format("{:g} must be >= 0", o.kv));
  o.min_control = table.number_or("min_control", "1", o.min_control);
  o.max_control = table.number_or("max_control", "1", o.max_control);
  if (!(o.min_control >= 0.0 && o.min_control < 1.0))
    table.fail("min_control", fmt::format("{:g} must be from 0 to below 1", o.min_control));
  if (!(o.max_control > o.min_control && o.max_control <= 1.0)) {
    table.fail("max_control",
               fmt::format("{:g} must be above min_control = {:g} and at most 1", o.max_control, o.min_control));
  }
  o.begin = study.begin;
  o.end = study.end;
  o.reserve_force = study.reserve_force;
  o.accuracy = study.accuracy;
  o.rate_Hz = study.rate_Hz;
}

void read_static(const StudyTable& table, MuscleStudy& study) {
  StaticOptimizationOptions& o = study.static_optimization;
  o.exponent = table.number_or("exponent", "1", o.exponent);
  if (!(o.exponent > 1.0 && o.exponent <= 100.0))
    table.fail("exponent", fmt::format("{:g} must be above 1, at most 100", o.exponent));
  const std::vector<std::string> names = {"with passive", "as opensim", "without physiology"};
  const std::string name = table.choice_or("formulation", names, names[0]);
  o.force = name == names[0]   ? StaticForce::kWithPassive
            : name == names[1] ? StaticForce::kAsOpenSim
                               : StaticForce::kIsometric;
  if (study.reserve_force > 0.0) o.reserve.assign(study.system->coordinates(), study.reserve_force);
}

/// Keys of other methods: files and ramps were meant to matter, so say that they do not. Tables of excitations and
/// speeds may stay while a study's method changes.
void refuse_other_methods(const StudyTable& motion, MuscleMethod method) {
  const bool forward = method == MuscleMethod::kForward;
  for (const char* key : {"file", "low_pass", "ramp"}) {
    if (motion.has(key) && forward) {
      motion.fail(key, "is a wished motion, which method = \"forward\" has no use for; the other methods follow one");
    }
  }
  for (const char* key : {"start_file", "excitation_file", "interpolation"}) {
    if (motion.has(key) && !forward)
      motion.fail(key, fmt::format("has no meaning when method = \"{}\"", method_name(method)));
  }
  for (const char* key : {"start_speed", "excitation", "excitation_step"}) static_cast<void>(motion.has(key));
}

}  // namespace

std::string_view method_name(MuscleMethod method) {
  switch (method) {
    case MuscleMethod::kForward:
      return "forward";
    case MuscleMethod::kInverseDynamics:
      return "inverse dynamics";
    case MuscleMethod::kStaticOptimization:
      return "static optimization";
    case MuscleMethod::kComputedMuscleControl:
      break;
  }
  return "computed muscle control";
}

bool is_muscle_study(const StudyTable& root) {
  return root.is_table("subject") && root.table("subject").is_text("model");
}

MuscleStudy read_muscle_study(const StudyTable& root) {
  MuscleStudy study;
  study.title = root.text_or("title", "");
  static_cast<void>(root.integer_or("seed", 1));  // nothing here is random; `--seed` sets it all the same
  const StudyTable motion = root.table("motion");
  const std::vector<std::string> methods = {"forward", "inverse dynamics", "static optimization",
                                            "computed muscle control"};
  const std::string method = motion.choice_or("method", methods, "forward");
  study.method = static_cast<MuscleMethod>(std::find(methods.begin(), methods.end(), method) - methods.begin());
  refuse_other_methods(motion, study.method);
  read_subject(root.table("subject"), study);
  study.motion.coordinate.resize(study.system->model().coordinates.size());
  read_times(motion, study);
  read_start(motion, study);
  if (study.method == MuscleMethod::kForward) {
    read_start_file(motion, study);
    read_excitations(motion, study);
  } else {
    read_wish(motion, study);
  }
  // Read in any case, so that a study can keep them while its method changes.
  read_control(motion.table_or_empty("control"), study);
  read_static(motion.table_or_empty("static_optimization"), study);
  if (study.title.empty()) study.title = study.system->model().name;
  return study;
}

}  // namespace veridyn::muscle
