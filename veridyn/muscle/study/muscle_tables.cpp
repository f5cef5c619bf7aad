// The tables and storage files of a muscle study's result.
#include <fmt/format.h>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/osim/joint_speeds.hpp"
#include "veridyn/muscle/study/muscle_run.hpp"

namespace veridyn::muscle {
namespace {

std::vector<double> column(const estimation::RowMatrix& matrix, std::size_t index) {
  std::vector<double> values(static_cast<std::size_t>(matrix.rows()));
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) values[i] = matrix(i, index);
  return values;
}

bool all_zero(const estimation::RowMatrix& matrix) { return matrix.size() == 0 || matrix.isZero(0.0); }

}  // namespace

Recording motion_table(const MuscleStudy& study, const MuscleResult& result) {
  const Model& model = study.system->model();
  const MuscleTrajectory& t = result.trajectory;
  const TimeBase time = make_time_base(t.time);
  Recording recording;
  recording.source = study.title;
  for (std::size_t c = 0; c < model.coordinates.size(); ++c) {
    const Coordinate& k = model.coordinates[c];
    const std::string force_unit = k.unit() == "m" ? "N" : "N m";
    recording.add(make_channel(k.name, k.unit(), time, column(t.q, c)));
    recording.add(make_channel(k.name + "_speed", k.unit() + "/s", time, column(t.qdot, c)));
    if (study.method == MuscleMethod::kComputedMuscleControl)
      recording.add(make_channel(k.name + "_desired", k.unit(), time, column(result.desired, c)));
    if (result.generalized_force.size() > 0)
      recording.add(make_channel(k.name + "_force", force_unit, time, column(result.generalized_force, c)));
    if (!all_zero(t.reserve)) recording.add(make_channel(k.name + "_reserve", force_unit, time, column(t.reserve, c)));
  }
  return recording;
}

Recording muscle_table(const MuscleStudy& study, const MuscleResult& result) {
  const Model& model = study.system->model();
  const MuscleTrajectory& t = result.trajectory;
  const TimeBase time = make_time_base(t.time);
  Recording recording;
  recording.source = study.title;
  const auto add = [&](const std::string& name, const char* unit, const estimation::RowMatrix& values, std::size_t m) {
    if (values.size() > 0) recording.add(make_channel(name, unit, time, column(values, m)));
  };
  for (std::size_t m = 0; m < model.muscles.size(); ++m) {
    const std::string& name = model.muscles[m].name();
    add(name + "_excitation", "1", t.excitation, m);
    add(name + "_activation", "1", t.activation, m);
    add(name + "_fiber_length", "m", t.fiber_length, m);
    add(name + "_tendon_force", "N", t.tendon_force, m);
    add(name + "_path_length", "m", t.path_length, m);
  }
  return recording;
}

Recording reaction_table(const MuscleStudy& study, const MuscleResult& result) {
  const TimeBase time = make_time_base(result.trajectory.time);
  Recording recording;
  recording.source = study.title;
  const JointReactions& reactions = *result.reactions;
  for (std::size_t k = 0; k < reactions.joints.size(); ++k) {
    const std::string& name = study.system->model().joints[reactions.joints[k]].name;
    for (std::size_t axis = 0; axis < 3; ++axis)
      recording.add(
          make_channel(fmt::format("{}_f{}", name, "xyz"[axis]), "N", time, column(reactions.force, 3 * k + axis)));
    for (std::size_t axis = 0; axis < 3; ++axis)
      recording.add(
          make_channel(fmt::format("{}_m{}", name, "xyz"[axis]), "N m", time, column(reactions.moment, 3 * k + axis)));
  }
  return recording;
}

Recording metabolic_table(const MuscleStudy& study, const MuscleResult& result) {
  const TimeBase time = make_time_base(result.trajectory.time);
  Recording recording;
  recording.source = study.title;
  const MetabolicCost& cost = *result.metabolic;
  std::vector<double> total(cost.power.rows(), cost.basal);
  for (Eigen::Index m = 0; m < cost.power.cols(); ++m) {
    recording.add(make_channel(study.system->model().muscles[m].name() + "_power", "W", time, column(cost.power, m)));
    for (std::size_t i = 0; i < total.size(); ++i) total[i] += cost.power(i, m);
  }
  recording.add(make_channel("basal_power", "W", time, std::vector<double>(total.size(), cost.basal)));
  recording.add(make_channel("total_power", "W", time, total));
  return recording;
}

Recording induced_table(const MuscleStudy& study, const MuscleResult& result) {
  const TimeBase time = make_time_base(result.trajectory.time);
  Recording recording;
  recording.source = study.title;
  const InducedAccelerations& induced = *result.induced;
  for (std::size_t c = 0; c < induced.coordinates.size(); ++c) {
    const Coordinate& k = study.system->model().coordinates[induced.coordinates[c]];
    for (std::size_t s = 0; s < induced.sources.size(); ++s)
      recording.add(make_channel(fmt::format("{}_by_{}", k.name, induced.sources[s]), k.unit() + "/s^2", time,
                                 column(induced.part[c], s)));
  }
  return recording;
}

std::optional<ContactRecord> contact_record(const MuscleStudy& study, const MuscleResult& result) {
  const bool moved = study.method == MuscleMethod::kForward || study.method == MuscleMethod::kComputedMuscleControl;
  if (!moved || study.system->model().body_forces.contacts.empty()) return std::nullopt;
  return record_contacts(*study.system, result.trajectory.time, result.trajectory.q, result.trajectory.qdot);
}

io::Storage state_storage(const MuscleStudy& study, const MuscleResult& result) {
  const Model& model = study.system->model();
  const MuscleTrajectory& t = result.trajectory;
  const StateLayout& layout = study.system->layout();
  estimation::RowMatrix speed = t.qdot;
  for (Eigen::Index i = 0; i < speed.rows(); ++i)
    speed.row(i) = opensim_speeds(model, t.q.row(i).transpose(), t.qdot.row(i).transpose()).transpose();
  io::Storage storage;
  storage.source = "states.sto";
  storage.name = model.name.empty() ? "states" : model.name;
  storage.time = t.time;
  std::vector<std::pair<const estimation::RowMatrix*, Eigen::Index>> columns;
  const auto add = [&](std::string label, const estimation::RowMatrix& matrix, std::size_t index) {
    storage.labels.push_back(std::move(label));
    columns.emplace_back(&matrix, static_cast<Eigen::Index>(index));
  };
  for (std::size_t c = 0; c < model.coordinates.size(); ++c) {
    const Coordinate& k = model.coordinates[c];
    const std::string place = fmt::format("/jointset/{}/{}", model.joints[k.joint].name, k.name);
    add(place + "/value", t.q, c);
    add(place + "/speed", speed, c);
  }
  for (std::size_t m = 0; m < model.muscles.size(); ++m) {
    const std::string place = "/forceset/" + model.muscles[m].name();
    if (layout.activation[m] >= 0 && t.activation.size() > 0) add(place + "/activation", t.activation, m);
    // Static optimisation has rigid tendons: its fibre lengths are no states.
    if (layout.fiber_length[m] >= 0 && t.fiber_length.size() > 0 && study.method != MuscleMethod::kStaticOptimization)
      add(place + "/fiber_length", t.fiber_length, m);
  }
  for (Eigen::Index i = 0; i < signed_index(t.time.size()); ++i) {
    for (const auto& [matrix, index] : columns) storage.values.push_back((*matrix)(i, index));
  }
  return storage;
}

std::optional<io::Storage> control_storage(const MuscleStudy& study, const MuscleResult& result) {
  if (!result.controls) return std::nullopt;
  const Model& model = study.system->model();
  const ControlSignals& excitation = result.controls->excitation;
  const ControlSignals& reserve = result.controls->reserve;
  std::vector<int> reserved;
  if (reserve.size() > 0) {
    const std::span<const int> free = study.system->reduction().free();
    reserved.assign(free.begin(), free.end());
  }
  io::Storage storage;
  storage.source = "controls.sto";
  storage.name = "controls";
  for (const Muscle& m : model.muscles) storage.labels.push_back(m.name());
  for (const int c : reserved) storage.labels.push_back(model.coordinates[c].name + "_reserve");
  // All instants at which either of them has a sample.
  std::vector<double> times(excitation.times().begin(), excitation.times().end());
  if (!reserved.empty()) times.insert(times.end(), reserve.times().begin(), reserve.times().end());
  std::erase_if(times, [&](double t) { return t < study.begin || t > study.end; });
  times.push_back(study.begin);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  std::vector<double> u(model.muscles.size()), r(reserve.size());
  const auto append = [&](double time, double value_at) {
    excitation.evaluate(value_at, u.data());
    if (!reserved.empty()) reserve.evaluate(value_at, r.data());
    storage.time.push_back(time);
    storage.values.insert(storage.values.end(), u.begin(), u.end());
    // Without an optimal force, what the muscles lacked is in newtons or newton metres.
    for (const int c : reserved) storage.values.push_back(r[c] / (study.reserves[c] > 0.0 ? study.reserves[c] : 1.0));
  };
  constexpr double kJust = 1e-9;  // before a jump [s]
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (i > 0 && excitation.interpolation() == Interpolation::kHold && times[i] - times[i - 1] > 2.0 * kJust)
      append(times[i] - kJust, times[i - 1]);
    append(times[i], times[i]);
  }
  if (times.back() < study.end) append(study.end, study.end);
  return storage;
}

}  // namespace veridyn::muscle
