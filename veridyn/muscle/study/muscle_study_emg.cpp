#include "veridyn/muscle/study/muscle_study_emg.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/muscle/dynamics/coordinate_forces.hpp"
#include "veridyn/muscle/identification/measured_motion.hpp"
#include "veridyn/muscle/study/muscle_study_parts.hpp"

namespace veridyn::muscle {
namespace {

/// Values are compared no denser than this: moments of motions have no more in them.
constexpr double kComparedRate_Hz = 100.0;
/// Moments beyond this many times what all muscles make at their F0 together are none of theirs.
constexpr double kBeyondMuscles = 4.0;
/// Envelopes that never reach this of full scale look like volts; above 1 as much again is a contraction beyond the
/// maximum.
constexpr double kLikeVolts = 2e-3, kAboveMaximum = 0.25;

/// What `read` throws of a file is said at the key that names it.
template <typename Read>
auto at_key(const StudyTable& table, const char* key, const Read& read) {
  try {
    return read();
  } catch (const InputError& error) {
    table.fail(key, error.what());
  }
}

std::string muscles_of(const EmgSettings& settings, const Model& model, std::size_t signal) {
  std::vector<std::string> names;
  for (std::size_t m = 0; m < model.muscles.size(); ++m)
    if (settings.signal_of[m] == static_cast<int>(signal)) names.push_back(model.muscles[m].name());
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Refuses what is no envelope; `column` is of the table.
void check_envelope(const SignalTable& table, std::size_t column, const std::string& name, double maximum) {
  const std::vector<double>& v = table.values[column];
  double least = kInfinity, largest = -kInfinity;
  std::size_t at_least = 0, at_largest = 0;
  for (std::size_t k = 0; k < v.size(); ++k) {
    if (!std::isfinite(v[k]))
      throw InputError(table.source, fmt::format("column '{}' has no value at {:g} s", name, table.time[k]));
    if (v[k] < least) least = v[k], at_least = k;
    if (v[k] > largest) largest = v[k], at_largest = k;
  }
  if (least < -1e-6 * std::max(1.0, maximum))
    throw InputError(table.source,
                     fmt::format("column '{}' is {:.4g} at {:g} s: a raw signal where an envelope of 0 .. 1 is wanted; "
                                 "high-pass, rectify and low-pass it, and give its maximum as emg.maximum.{}",
                                 name, least, table.time[at_least], name));
  if (largest > (1.0 + kAboveMaximum) * maximum)
    throw InputError(
        table.source,
        fmt::format("column '{}' goes to {:.4g} at {:g} s where {:g} stands for the maximum: envelopes are "
                    "within 0 .. 1; give its value at maximum voluntary contraction as emg.maximum.{}",
                    name, largest, table.time[at_largest], maximum, name));
  if (largest < kLikeVolts * maximum)
    throw InputError(
        table.source,
        fmt::format("column '{}' goes to {:.3g} at most, which looks like volts where an envelope of 0 .. 1 "
                    "is wanted; give its value at maximum voluntary contraction as emg.maximum.{}",
                    name, largest, name));
}

std::vector<ControlSignals> read_envelopes(const SignalTable& table, const EmgSettings& settings, const Model& model) {
  check_times(table);
  std::vector<ControlSignals> emg;
  for (std::size_t i = 0; i < settings.signals.size(); ++i) {
    const std::string& name = settings.signals[i];
    const int column = table.find(name, "emg");
    if (column < 0)
      throw InputError(table.source,
                       fmt::format("has no column '{}' for {}{}; a muscle without an electrode shares another's in "
                                   "[emg.columns], or is named in emg.resting",
                                   name, muscles_of(settings, model, i), suggestion(name, table.names)));
    check_envelope(table, at(column), name, settings.maximum[i]);
    std::vector<double> values = table.values[column];
    for (double& v : values) v = std::clamp(v / settings.maximum[i], 0.0, 1.0);
    emg.emplace_back(table.time, std::move(values), 1, Interpolation::kLinear);
  }
  return emg;
}

/// Coordinates that move muscles have to be in the file, or the study says where they rest.
void check_coordinates(const StudyTable& task, const MuscleSubject& subject, const Motion& angles,
                       std::span<const char> given) {
  const MusculoskeletalSystem& system = *subject.system;
  for (std::size_t c = 0; c < system.coordinates(); ++c) {
    if (angles.coordinate[c] || given[c] != 0) continue;
    if (system.reduction().role(static_cast<int>(c)) != CoordinateRole::kFree) continue;
    const auto pairs = system.pairs();
    const bool crossed = std::any_of(pairs.begin(), pairs.end(), [&](const auto& p) { return at(p.coordinate) == c; });
    const std::string& name = system.model().coordinates[c].name;
    if (crossed)
      task.fail("angles", fmt::format("has no column of coordinate '{}', which muscles cross; say where it rests: "
                                      "[task.held] {} = ...",
                                      name, name));
  }
}

/// Moments that no muscle makes, or far beyond what all of them make.
void check_capacity(const SignalTable& table, const MuscleSubject& subject, std::span<const MuscleOutput> outputs,
                    const EmgRecording& recording) {
  const MusculoskeletalSystem& system = *subject.system;
  std::vector<double> some;
  for (std::size_t k = 0; k < recording.time.size(); k += std::max<std::size_t>(1, recording.time.size() / 20))
    some.push_back(recording.time[k]);
  const EmgSegment poses = along_motion(system, recording.angles, recording.rest, recording.begin, some, outputs);
  const std::size_t muscles = system.muscles().size();
  for (std::size_t o = 0; o < outputs.size(); ++o) {
    if (outputs[o].kind != MuscleOutputKind::kMoment) continue;
    double capacity = 0.0, peak = 0.0;
    for (Eigen::Index k = 0; k < poses.arm.rows(); ++k) {
      double sum = 0.0;
      for (std::size_t m = 0; m < muscles; ++m)
        sum += std::abs(poses.arm(k, o * muscles + m)) * system.muscles().settings(m).musculotendon.max_isometric_force;
      capacity = std::max(capacity, sum);
    }
    bool any = false;
    for (Eigen::Index k = 0; k < recording.measured.rows(); ++k) {
      const double value = std::abs(recording.measured(k, o));
      any = any || !std::isnan(value);
      if (value > peak) peak = value;
    }
    if (!any) continue;
    const std::string name = output_name(system.model(), outputs[o]);
    if (!(capacity > 0.0))
      throw InputError(table.source, fmt::format("'{}': no muscle of the model moves this coordinate", name));
    if (peak > kBeyondMuscles * capacity)
      throw InputError(table.source, fmt::format("'{}' goes to {:.4g} {} where all muscles at their F0 make {:.3g}{}",
                                                 name, peak, output_unit(system.model(), outputs[o]), capacity,
                                                 1e-3 * peak < kBeyondMuscles * capacity
                                                     ? ": these are N mm taken for N m, a factor of 1000"
                                                     : ": another unit, or another model"));
  }
}

/// Outputs at the times that are compared.
struct ComparedOutputs {
  std::vector<double> time;
  estimation::RowMatrix values;
};

/// Rows of the outputs inside the times that angles and EMG share, no denser than needed, without limit forces.
ComparedOutputs outputs_within(const MeasuredMotion& measured, const MuscleSubject& subject,
                               const EmgSettings& settings, std::span<const MuscleOutput> outputs,
                               const EmgRecording& recording, double end) {
  std::vector<Eigen::Index> rows;
  std::size_t inside = 0;
  double last = -kInfinity;
  for (std::size_t k = 0; k < measured.time.size(); ++k) {
    const double t = measured.time[k];
    if (t < recording.begin || t > end) continue;
    ++inside;
    if (t < recording.begin + settings.settle_s || t - last < (1.0 - 1e-6) / kComparedRate_Hz) continue;
    rows.push_back(signed_index(k));
    last = t;
  }
  constexpr std::size_t kFewest = 10;
  if (2 * inside < measured.time.size() || rows.size() < kFewest)
    throw InputError(
        measured.source,
        fmt::format("is of {:g} to {:g} s, angles and EMG both of {:g} to {:g} s: the files need one "
                    "clock, and {} common samples after the first {:g} s",
                    measured.time.front(), measured.time.back(), recording.begin, end, kFewest, settings.settle_s));
  const Model& model = subject.system->model();
  ComparedOutputs compared;
  compared.values.resize(rows.size(), outputs.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    compared.time.push_back(measured.time[rows[k]]);
    compared.values.row(k) = measured.values.row(rows[k]);
    Eigen::VectorXd q = recording.rest, qdot = Eigen::VectorXd::Zero(q.size()), limit = qdot;
    for (std::size_t c = 0; c < recording.angles.coordinate.size(); ++c) {
      if (!recording.angles.coordinate[c]) continue;
      const auto value = recording.angles.coordinate[c]->evaluate(compared.time.back());
      q(c) = value.value;
      qdot(c) = value.slope;
    }
    add_coordinate_forces<double>(model, q.data(), qdot.data(), limit.data());
    for (std::size_t o = 0; o < outputs.size(); ++o)
      if (outputs[o].kind == MuscleOutputKind::kMoment) compared.values(k, o) -= limit(outputs[o].index);
  }
  return compared;
}

}  // namespace

const KeyTable<EmgSettings>& EmgSettings::keys() {
  using S = EmgSettings;
  static const auto error =
      KeyTable<EmgError>("emg")
          .number("noise", &EmgError::relative, "1", internal::kBelowOne,
                  "of the envelopes, standard deviation over their value before the recording says more; 0: they are "
                  "exact")
          .number("noise_floor", &EmgError::absolute, "1", internal::kBelowOne, "besides, over full scale")
          .number("bandwidth", &EmgError::bandwidth_Hz, "Hz", kPositive,
                  "of the envelopes: how fast their error changes");
  static const auto table =
      KeyTable<S>("emg", "Muscles along recorded angles, driven by EMG.")
          .with(&S::error, error)
          .number("delay", &S::delay_s, "s", kAnyNumber,
                  "of the muscles behind their EMG, where no `[[parameter]]` is a delay")
          .number("delay_sigma", &S::delay_sigma_s, "s", kNotNegative,
                  "standard deviation of what is known of it; 0: it is known")
          .number("low_pass", &S::low_pass_Hz, "Hz", kPositive, "of the angles, without delay")
          .otherwise("none")
          .number("settle", &S::settle_s, "s", kNotNegative, "of each recording that is not compared")
          .elsewhere({"resting", "", "", "none", "muscles without EMG that stay at their least activation", true})
          .elsewhere({"columns", "", "", "the muscle's name",
                      "a table: column of a `MUSCLE`; several muscles may share one", true})
          .elsewhere({"maximum", "the files'", "> 0", "1",
                      "a table: of a column its value at maximum voluntary contraction", true});
  return table;
}

EmgSettings read_emg(const StudyTable& table, const Model& model) {
  EmgSettings s = EmgSettings::keys().read(table);
  std::vector<std::string> column;
  for (const Muscle& muscle : model.muscles) column.push_back(muscle.name());
  const StudyTable columns = table.table_or_empty("columns");
  std::vector<char> named(column.size(), 0);
  for (const std::string& key : columns.keys()) {
    const std::size_t m = internal::muscle_of(columns, key, key, model);
    column[m] = columns.text(key);
    named[m] = 1;
  }
  s.signal_of.assign(column.size(), 0);
  if (table.has("resting")) {
    for (const std::string& name : table.texts("resting")) {
      const std::size_t m = internal::muscle_of(table, "resting", name, model);
      if (named[m] != 0) table.fail("resting", fmt::format("names '{}', which has a column in [emg.columns]", name));
      s.signal_of[m] = -1;
    }
  }
  for (std::size_t m = 0; m < column.size(); ++m) {
    if (s.signal_of[m] < 0) continue;
    const auto found = std::find(s.signals.begin(), s.signals.end(), column[m]);
    s.signal_of[m] = static_cast<int>(found - s.signals.begin());
    if (found == s.signals.end()) s.signals.push_back(column[m]);
  }
  if (s.signals.empty()) table.fail("resting", "leaves no muscle that EMG drives");
  s.maximum.assign(s.signals.size(), 1.0);
  const StudyTable maximum = table.table_or_empty("maximum");
  for (const std::string& key : maximum.keys()) {
    const auto found = std::find(s.signals.begin(), s.signals.end(), key);
    if (found == s.signals.end())
      maximum.fail(key, fmt::format("is no column of the EMG{}", suggestion(key, s.signals)));
    s.maximum[found - s.signals.begin()] = maximum.positive(key, "1");
  }
  return s;
}

EmgTask read_emg_recording(const StudyTable& task, const MuscleSubject& subject, const EmgSettings& settings,
                           std::span<const MuscleOutput> outputs, const Eigen::VectorXd& rest,
                           std::span<const char> given) {
  EmgTask read;
  const Model& model = subject.system->model();
  for (const char* key : {"angles", "moments", "emg"}) {
    if (!task.has(key)) task.fail(key, "is missing: a recorded task has angles, moments and emg");
    read.inputs.push_back(task.file(key));
  }
  EmgRecording& recording = read.recording;
  recording.rest = rest;
  recording.angles = at_key(task, "angles", [&] {
    const SignalTable table = read_signals(task.file("angles"));
    check_times(table);
    refuse_degrees(table, model);
    return make_motion(table, model, {.low_pass_Hz = settings.low_pass_Hz});
  });
  check_coordinates(task, subject, recording.angles, given);
  for (const std::string& name : recording.angles.beyond_range)
    read.notes.push_back(fmt::format("{}: '{}' leaves the model's range", task.text("name"), name));
  recording.emg = at_key(task, "emg", [&] { return read_envelopes(read_signals(task.file("emg")), settings, model); });
  recording.begin = std::max(recording.angles.begin, recording.emg.front().times().front());
  const double end = std::min(recording.angles.end, recording.emg.front().times().back());
  if (!(end > recording.begin))
    task.fail("emg", fmt::format("is of {:g} to {:g} s, the angles are of {:g} to {:g} s: the files need one clock",
                                 recording.emg.front().times().front(), recording.emg.front().times().back(),
                                 recording.angles.begin, recording.angles.end));
  at_key(task, "moments", [&] {
    const SignalTable table = read_signals(task.file("moments"));
    const MeasuredMotion measured = read_measured_motion(table, model, outputs);
    ComparedOutputs compared = outputs_within(measured, subject, settings, outputs, recording, end);
    recording.time = std::move(compared.time);
    recording.measured = std::move(compared.values);
    check_capacity(table, subject, outputs, recording);
  });
  const double knots = (end - recording.begin) / settings.error.spacing();
  constexpr double kMostErrors = 3000.0;
  if (settings.error.any() && knots * static_cast<double>(settings.signals.size()) > kMostErrors)
    task.fail("emg", fmt::format("is of {:.3g} s, whose errors are more than {:g} numbers: cut it into several tasks",
                                 end - recording.begin, kMostErrors));
  read.end = end;
  return read;
}

}  // namespace veridyn::muscle
