#include "veridyn/muscle/simulation/pose_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <span>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/units.hpp"
#include "veridyn/io/tables/table.hpp"
#include "veridyn/muscle/dynamics/inverse_dynamics.hpp"
#include "veridyn/muscle/model/signals.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"

namespace veridyn::muscle {
namespace {

void check_range(const Model& model, const std::string& place, Eigen::Index index, double value) {
  const Coordinate& c = model.coordinates[index];
  if (!std::isfinite(value)) throw InputError(place, fmt::format("coordinate '{}' is not a finite number", c.name));
  if (!c.in_range(value)) throw InputError(place, c.outside_range(value));
}

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

/// "elbow_flexion=90 deg"; the coordinate.
int read_assignment(const Model& model, const std::string& text, Eigen::VectorXd& q) {
  const std::string place = "--pose";
  const std::size_t equal = text.find('=');
  if (equal == std::string::npos) throw InputError(place, fmt::format("'{}' is neither a file nor NAME=VALUE", text));
  const std::string name = trimmed(text.substr(0, equal)), value = trimmed(text.substr(equal + 1));
  const int index = model.coordinate(name);
  if (index < 0) throw InputError(place, model.no_coordinate(name));
  std::size_t used = 0;
  double number = 0.0;
  try {
    number = std::stod(value, &used);
  } catch (const std::exception&) {
    throw InputError(place, fmt::format("'{}' is not a number for coordinate '{}'", value, name));
  }
  if (const std::string unit = trimmed(value.substr(used)); !unit.empty()) {
    try {
      number = parse_unit_like(unit, parse_unit(model.coordinates[index].unit())).to_si(number);
    } catch (const InputError& error) {
      throw InputError(place, fmt::format("coordinate '{}': {}", name, error.what()));
    }
  }
  check_range(model, place, index, number);
  q(index) = number;
  return index;
}

/// Files are printed with six digits or so.
bool differ(double given, double coupled) { return std::abs(given - coupled) > 1e-5 * (1.0 + std::abs(coupled)); }

/// Puts coupled coordinates where their couplers have them.
void couple(const Model& model, PoseTable& poses, std::span<const std::uint8_t> given, bool is_file) {
  const CoordinateReduction reduction(model);
  for (const CoordinateReduction::Coupler& coupler : reduction.couplers()) {
    const Coordinate& dependent = model.coordinates[coupler.dependent];
    const std::string& leader = model.coordinates[coupler.independent].name;
    double largest = 0.0;
    std::size_t rows = 0;
    for (std::size_t i = 0; i < poses.q.size(); ++i) {
      const numerics::FunctionValue<double> f = coupler.function.evaluate(poses.q[i](coupler.independent));
      const double speed = poses.qdot[i](coupler.independent), was = poses.q[i](coupler.dependent);
      if (given[coupler.dependent] != 0 && differ(was, f.value)) {
        if (!is_file)
          throw InputError(
              "--pose", fmt::format("coordinate '{}' = {:.6g} {} follows '{}' through a coupler, which "
                                    "gives {:.6g} {}; leave it out, or set '{}'",
                                    dependent.name, was, dependent.unit(), leader, f.value, dependent.unit(), leader));
        ++rows;
        largest = std::max(largest, std::abs(was - f.value));
      }
      poses.q[i](coupler.dependent) = f.value;
      poses.qdot[i](coupler.dependent) = f.slope * speed;
      poses.qddot[i](coupler.dependent) = f.slope * poses.qddot[i](coupler.independent) + f.curvature * speed * speed;
    }
    if (rows > 0)
      poses.warnings.push_back(
          fmt::format("'{}' follows '{}' through a coupler: in {} of {} rows the file's value is another, by up to "
                      "{:.4g} {}; the coupler's is used",
                      dependent.name, leader, rows, poses.q.size(), largest, dependent.unit()));
  }
}

/// Values and derivatives of coordinates from named columns.
template <typename Column>
PoseTable from_columns(const Model& model, const std::string& place, std::size_t rows, const Column& column) {
  std::vector<std::uint8_t> given(model.coordinates.size(), 0), coupled(model.coordinates.size(), 0);
  for (const CoordinateCoupler& coupler : model.couplers) coupled[coupler.dependent] = 1;
  PoseTable poses;
  const Eigen::VectorXd rest = model.default_pose();
  poses.q.assign(rows, rest);
  poses.qdot.assign(rows, Eigen::VectorXd::Zero(rest.size()));
  poses.qddot.assign(rows, Eigen::VectorXd::Zero(rest.size()));
  bool any = false;
  for (Eigen::Index c = 0; c < rest.size(); ++c) {
    const Coordinate& coordinate = model.coordinates[c];
    const auto fill = [&](std::vector<Eigen::VectorXd>& to, const char* suffix, bool ranged) {
      const std::vector<double> values = column(coordinate, suffix);
      if (values.empty()) return;
      any = true;
      if (ranged) given[c] = 1;
      for (std::size_t i = 0; i < rows; ++i) {
        // Where a coupled one ends up is its coupler's affair.
        if (ranged && coupled[c] == 0) check_range(model, fmt::format("{}, row {}", place, i + 1), c, values[i]);
        if (!std::isfinite(values[i]))
          throw InputError(place, fmt::format("row {}: '{}' is not a finite number", i + 1, coordinate.name));
        to[i](c) = values[i];
      }
    };
    fill(poses.q, "value", true);
    fill(poses.qdot, "speed", false);
    fill(poses.qddot, "acceleration", false);
  }
  couple(model, poses, given, true);
  if (!any)
    throw InputError(place, fmt::format("no column is a coordinate of model '{}' ({})", model.name,
                                        fmt::join(model.coordinate_names(), ", ")));
  return poses;
}

PoseTable read_csv(const Model& model, const std::string& file) {
  const io::Table table = io::read_table(file);
  const auto column = [&](const Coordinate& coordinate, const std::string& suffix) -> std::vector<double> {
    for (const io::TableColumn& c : table.columns) {
      if (c.name == coordinate.name + "." + suffix || (suffix == "value" && c.name == coordinate.name)) return c.value;
    }
    return {};
  };
  PoseTable poses = from_columns(model, file, table.rows(), column);
  for (const io::TableColumn& c : table.columns) {
    if (c.name == "time") poses.time = c.value;
  }
  return poses;
}

PoseTable read_motion(const Model& model, const std::string& file) {
  const SignalTable table = read_signals(file);
  const auto column = [&](const Coordinate& coordinate, const std::string& suffix) -> std::vector<double> {
    const int index =
        suffix == "value" ? table.find(coordinate.name, suffix) : table.find(coordinate.name + "/" + suffix, suffix);
    if (index < 0) return {};
    std::vector<double> values = table.values[index];
    if (table.rotations_in_degrees && coordinate.motion == CoordinateMotion::kRotational) {
      for (double& v : values) v *= kDegree;
    }
    return values;
  };
  PoseTable poses = from_columns(model, file, table.time.size(), column);
  poses.time = table.time;
  return poses;
}

}  // namespace

PoseTable read_poses(const Model& model, const std::string& text) {
  PoseTable poses;
  if (std::filesystem::exists(text)) {
    poses = text.ends_with(".csv") ? read_csv(model, text) : read_motion(model, text);
  } else {
    Eigen::VectorXd q = model.default_pose();
    std::vector<std::uint8_t> given(model.coordinates.size(), 0);
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find(',', begin), text.size());
      if (const std::string part = trimmed(text.substr(begin, end - begin)); !part.empty())
        given[read_assignment(model, part, q)] = 1;
      begin = end + 1;
    }
    poses.q = {q};
    poses.qdot = poses.qddot = {Eigen::VectorXd::Zero(q.size())};
    couple(model, poses, given, false);
  }
  return poses;
}

std::string pose_csv(const MusculoskeletalSystem& system, const PoseTable& poses) {
  const Model& model = system.model();
  const auto pairs = system.pairs();
  // An arm about a coordinate that others follow takes their motion along.
  std::vector<int> leader(model.coordinates.size(), -1);
  const auto couplers = system.reduction().couplers();
  for (const CoordinateReduction::Coupler& coupler : couplers) leader[coupler.dependent] = coupler.independent;
  std::vector<std::pair<int, int>> arms;
  for (const MusclePaths::Pair& pair : pairs) {
    int c = pair.coordinate;
    while (leader[c] >= 0) c = leader[c];
    if (arms.empty() || std::find(arms.begin(), arms.end(), std::pair{pair.muscle, c}) == arms.end())
      arms.emplace_back(pair.muscle, c);
  }
  std::string text;
  const auto cell = [&](const std::string& value) { text += (text.empty() || text.back() == '\n' ? "" : ",") + value; };
  if (!poses.time.empty()) cell("time[s]");
  for (const Coordinate& c : model.coordinates) cell(fmt::format("{}[{}]", c.name, c.unit()));
  for (const Muscle& muscle : model.muscles) cell(muscle.name() + ".length[m]");
  for (const auto& [m, c] : arms) {
    const Coordinate& coordinate = model.coordinates[c];
    cell(fmt::format("{}.moment_arm.{}[{}]", model.muscles[m].name(), coordinate.name,
                     coordinate.unit() == "m" ? "1" : "m"));
  }
  for (const Coordinate& c : model.coordinates)
    cell(fmt::format("{}.force[{}]", c.name, c.unit() == "m" ? "N" : "N m"));
  text += '\n';
  SystemEvaluator<double> evaluator(system);
  for (std::size_t i = 0; i < poses.q.size(); ++i) {
    evaluator.set_all(poses.q[i].data(), poses.qdot[i].data());
    const auto number = [&](double value) { cell(fmt::format("{}", value)); };
    if (!poses.time.empty()) number(poses.time[i]);
    for (const double q : poses.q[i]) number(q);
    for (const double length : evaluator.path_length()) number(length);
    for (const auto& [m, c] : arms) {
      double arm = 0.0;
      for (std::size_t k = 0; k < pairs.size(); ++k) {
        if (pairs[k].muscle != m) continue;
        double along = 1.0;
        int at = pairs[k].coordinate;
        while (leader[at] >= 0) {
          for (const CoordinateReduction::Coupler& coupler : couplers) {
            if (coupler.dependent != at) continue;
            along *= coupler.function.evaluate(poses.q[i](coupler.independent)).slope;
          }
          at = leader[at];
        }
        if (at == c) arm -= along * evaluator.path_gradient()[k];
      }
      number(arm);
    }
    for (const double force : inverse_dynamics(system.mechanism(), poses.q[i], poses.qdot[i], poses.qddot[i]))
      number(force);
    text += '\n';
  }
  return text;
}

}  // namespace veridyn::muscle
