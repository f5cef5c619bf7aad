// Where the motion of a muscle study starts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/osim/joint_speeds.hpp"
#include "veridyn/muscle/study/muscle_study_parts.hpp"

namespace veridyn::muscle::internal {
namespace {

/// The value of a column at a time, linear between samples.
double value_at(const SignalTable& table, int column, double time) {
  const std::vector<double>& t = table.time;
  const std::vector<double>& v = table.values[column];
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

}  // namespace

StartState read_start(const StudyTable& motion, const MuscleStudy& study) {
  const Model& model = study.system->model();
  StartState start = default_start(model);
  const StudyTable pose = motion.table_or_empty("start");
  for (const std::string& key : pose.keys()) {
    const std::size_t c = coordinate_of(pose, key, key, model);
    check_not_coupled(pose, key, c, study);
    start.q(c) = coordinate_value(pose, key, model.coordinates[c]);
    if (study.method != MuscleMethod::kForward && study.motion.coordinate[c])
      pose.fail(key, "and motion.file both say where it is");
  }
  const StudyTable speed = motion.table_or_empty("start_speed");
  for (const std::string& key : speed.keys()) {
    const std::size_t c = coordinate_of(speed, key, key, model);
    check_not_coupled(speed, key, c, study);
    const double value = speed.number(key, model.coordinates[c].unit() + "/s");
    if (study.method == MuscleMethod::kForward) start.qdot(c) = value;
  }
  return start;
}

ReadFromFiles<StartState> read_start_file(const StudyTable& motion, const MotionTable& keys, const MuscleStudy& study) {
  ReadFromFiles<StartState> read{.value = study.start};
  if (!keys.start_file) return read;
  const Model& model = study.system->model();
  const std::filesystem::path& path = *keys.start_file;
  const SignalTable table = read_signals(path);
  read.inputs.push_back(path);
  StartState& start = read.value;
  const double slack = 1e-9 * (1.0 + std::abs(study.begin));
  if (study.begin < table.time.front() - slack || study.begin > table.time.back() + slack) {
    motion.fail("start_file", fmt::format("has no state at {:g} s, only from {:g} to {:g} s", study.begin,
                                          table.time.front(), table.time.back()));
  }
  const auto value = [&](const std::string& name, std::string_view suffix, double otherwise) {
    const int column = state_column(table, name, suffix);
    return column < 0 ? otherwise : value_at(table, column, study.begin);
  };
  const auto muscles = signed_index(model.muscles.size());
  bool any = false;
  const auto unit = [&](std::size_t c) {
    return table.rotations_in_degrees && model.coordinates[c].motion == CoordinateMotion::kRotational ? kDegree : 1.0;
  };
  for (std::size_t c = 0; c < model.coordinates.size(); ++c) {
    const std::string& name = model.coordinates[c].name;
    any = any || state_column(table, name, "value") >= 0;
    start.q(c) = unit(c) * value(name, "value", start.q(c) / unit(c));
  }
  if (!any) motion.fail("start_file", fmt::format("{} has no column of a coordinate's value", path.string()));
  if (table.storage) start.qdot = opensim_speeds(model, study.start.q, start.qdot);
  for (std::size_t c = 0; c < model.coordinates.size(); ++c) {
    const std::string& name = model.coordinates[c].name;
    // "NAME_u" before OpenSim 4.
    const double otherwise = table.storage ? value(name, "u", start.qdot(c) / unit(c)) : start.qdot(c) / unit(c);
    start.qdot(c) = unit(c) * value(name, "speed", otherwise);
  }
  if (table.storage) {
    try {
      start.qdot = rates_of_opensim_speeds(model, start.q, start.qdot);
    } catch (const InputError& error) {
      motion.fail("start_file", fmt::format("{} at {:g} s: {}", path.string(), study.begin, error.what()));
    }
  }
  Eigen::VectorXd activation(muscles), fiber(muscles);
  bool all = true;
  for (Eigen::Index m = 0; m < muscles; ++m) {
    const MuscleParameters& p = model.muscles[m].parameters;
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
    start.activation = activation;
    start.fiber_length = fiber;
  } else {
    read.warnings.push_back(fmt::format(
        "{} does not have activation and fibre length of every muscle: muscles start at rest", path.string()));
  }
  return read;
}

}  // namespace veridyn::muscle::internal
