#include "veridyn/muscle/tasks/elbow_tasks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/muscle/model/ramp.hpp"

namespace veridyn::muscle {
namespace {

constexpr std::array kShoulder{-90.0, -45.0, 0.0, 45.0, 90.0, 135.0, 180.0};            // deg
constexpr std::array<std::array<double, 2>, 3> kRange{{{0, 90}, {0, 130}, {90, 130}}};  // deg

struct Position {
  bool extension = false;
  std::size_t shoulder = 0, range = 0;
};

Position position_of(int number) {
  if (number < 1 || number > kElbowTasks)
    throw InputError("elbow task", fmt::format("{} is none of 1 .. {}", number, kElbowTasks));
  const auto i = static_cast<std::size_t>(number - 1);
  return {i >= 21, i % 21 / 3, i % 3};
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// The coordinate called `name`, or the only one with `word` in its name.
std::string coordinate_called(const Model& model, const std::string& name, const char* word) {
  if (!name.empty()) {
    if (model.coordinate(name) < 0) throw InputError(word, model.no_coordinate(name));
    return name;
  }
  std::vector<std::string> found;
  for (const Coordinate& c : model.coordinates) {
    if (lower_case(c.name).find(word) != std::string::npos) found.push_back(c.name);
  }
  if (found.size() == 1) return found.front();
  throw InputError(word, found.empty()
                             ? fmt::format("is not given, and no coordinate of model '{}' has '{}' in its name (it has "
                                           "{})",
                                           model.name, word, fmt::join(model.coordinate_names(), ", "))
                             : fmt::format("is not given, and several coordinates of model '{}' could be meant: {}",
                                           model.name, fmt::join(found, ", ")));
}

}  // namespace

ElbowTask elbow_task(int number) {
  const Position p = position_of(number);
  const auto& range = kRange[p.range];
  return {kShoulder[p.shoulder] * kDegree, range[p.extension ? 1 : 0] * kDegree, range[p.extension ? 0 : 1] * kDegree};
}

std::string elbow_task_name(int number) {
  const Position p = position_of(number);
  return fmt::format("task {}: {} {:g}-{:g} deg, shoulder {:g} deg", number, p.extension ? "extension" : "flexion",
                     kRange[p.range][p.extension ? 1 : 0], kRange[p.range][p.extension ? 0 : 1], kShoulder[p.shoulder]);
}

ElbowTaskOptions resolved(const Model& model, ElbowTaskOptions options) {
  options.elbow = coordinate_called(model, options.elbow, "elbow");
  options.shoulder = coordinate_called(model, options.shoulder, "shoulder");
  if (options.elbow == options.shoulder)
    throw InputError("shoulder", fmt::format("is '{}' like elbow", options.shoulder));
  if (options.load_body.empty()) {
    const Coordinate& elbow = model.coordinates[model.coordinate(options.elbow)];
    options.load_body = model.bodies[model.joints[elbow.joint].child].name;
  }
  const int body = model.body(options.load_body);
  if (body <= 0) {
    std::vector<std::string> names;
    for (std::size_t i = 1; i < model.bodies.size(); ++i) names.push_back(model.bodies[i].name);
    throw InputError("load_body", fmt::format("'{}' is no body of model '{}' that could carry a load{}",
                                              options.load_body, model.name, suggestion(options.load_body, names)));
  }
  if (!options.load_location) options.load_location = 2.0 * model.bodies[body].mass_center;
  return options;
}

std::string obstacle(const Model& model, const ElbowTaskOptions& options, int number) {
  const ElbowTask task = elbow_task(number);
  const Coordinate& elbow = model.coordinates[model.coordinate(options.elbow)];
  const Coordinate& shoulder = model.coordinates[model.coordinate(options.shoulder)];
  // Ranges of files are rounded: 2.268928 is 130 deg.
  const auto beyond = [](const Coordinate& c, double value) { return value < c.low - 1e-5 || value > c.high + 1e-5; };
  if (beyond(shoulder, task.shoulder)) return shoulder.outside_range(task.shoulder);
  for (const double value : {task.from, task.to})
    if (beyond(elbow, value)) return elbow.outside_range(value);
  return {};
}

Task make_elbow_task(const Model& model, const ElbowTaskOptions& options, int number) {
  if (const std::string why = obstacle(model, options, number); !why.empty())
    throw InputError(elbow_task_name(number), why);
  const ElbowTask movement = elbow_task(number);
  Task task{.name = elbow_task_name(number), .number = number};
  task.end = options.start + options.duration;
  task.rate_Hz = options.rate_Hz;
  task.control = options.control;
  const int elbow = model.coordinate(options.elbow), shoulder = model.coordinate(options.shoulder);
  const auto within = [&](int c, double value) {
    return std::clamp(value, model.coordinates[c].low, model.coordinates[c].high);
  };
  task.held.push_back({shoulder, within(shoulder, movement.shoulder)});
  if (options.load > 0.0) task.loads.push_back({options.load_body, options.load, *options.load_location});
  task.desired.begin = task.begin;
  task.desired.end = task.end;
  task.desired.coordinate.resize(model.coordinates.size());
  const Eigen::VectorXd rest = model.default_pose();
  for (std::size_t c = 0; c < model.coordinates.size(); ++c) {
    const bool coupled = std::any_of(model.couplers.begin(), model.couplers.end(),
                                     [&](const CoordinateCoupler& k) { return at(k.dependent) == c; });
    if (!coupled) task.desired.coordinate[c] = resting_spline(rest(c));
  }
  task.desired.coordinate[shoulder] = resting_spline(task.held.front().value);
  const Ramp ramp{.start = options.start,
                  .duration = options.duration,
                  .from = within(elbow, movement.from),
                  .to = within(elbow, movement.to),
                  .shape = RampShape::kHalfSine};
  task.desired.coordinate[elbow] = ramp_spline({&ramp, 1});
  return task;
}

}  // namespace veridyn::muscle
