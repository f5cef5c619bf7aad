// What drives a forward simulation: excitations and reserves.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "veridyn/muscle/study/muscle_study_parts.hpp"

namespace veridyn::muscle::internal {
namespace {

double excitation(const StudyTable& table, const std::string& key) {
  return veridyn::internal::number_in(table, key, "1", from_to(0.0, 1.0));
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
ControlSignals reserves_of(const SignalTable& table, const MusculoskeletalSystem& system,
                           std::span<const double> reserves, Interpolation interpolation) {
  const Model& model = system.model();
  const std::size_t n = model.coordinates.size();
  std::vector<double> values(table.time.size() * n, 0.0);
  bool any = false;
  for (const int c : system.reduction().free()) {
    const int column = table.find(model.coordinates[c].name + "_reserve", "control");
    if (column < 0) continue;
    any = true;
    // Where there is no reserve, a file has what the muscles lacked in newtons or newton metres.
    const double force = reserves[c] > 0.0 ? reserves[c] : 1.0;
    for (std::size_t k = 0; k < table.time.size(); ++k) values[k * n + c] = force * table.values[column][k];
  }
  if (!any) return {};
  return without_repeats({table.time, std::move(values), n, interpolation});
}

}  // namespace

MuscleControls controls_of(const SignalTable& signals, const MusculoskeletalSystem& system,
                           std::span<const double> otherwise, Interpolation interpolation,
                           std::span<const double> reserves) {
  return {without_repeats(make_excitations(signals, system.model(), otherwise, interpolation)),
          reserves_of(signals, system, reserves, interpolation)};
}

ReadFromFiles<MuscleControls> read_excitations(const StudyTable& motion, const MotionTable& keys,
                                               const MuscleStudy& study) {
  const Model& model = study.system->model();
  const StudyTable table = motion.table_or_empty("excitation");
  std::vector<double> now(model.muscles.size(), table.has("default") ? excitation(table, "default") : 0.05);
  for (const std::string& key : table.keys()) {
    if (key == "default") continue;
    now[muscle_of(table, key, key, model)] = excitation(table, key);
  }
  const std::vector<StudyTable> steps = motion.tables("excitation_step");
  if (keys.excitation_file) {
    if (!steps.empty()) motion.fail("excitation_step", "and motion.excitation_file exclude each other");
    return {.value = controls_of(read_signals(*keys.excitation_file), *study.system, now, keys.interpolation,
                                 study.reserves),
            .inputs = {*keys.excitation_file}};
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
  return {
      .value = {.excitation = {std::move(times), std::move(values), now.size(), Interpolation::kHold}, .reserve = {}}};
}

}  // namespace veridyn::muscle::internal
