#include "veridyn/cueing/platform/platform.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/cueing/platform/platform_file.hpp"

namespace veridyn::cueing {
namespace {

StaticReach in_degrees(std::vector<double> commanded, std::vector<double> reached) {
  for (double& v : commanded) v *= kDegree;
  for (double& v : reached) v *= kDegree;
  return {std::move(commanded), std::move(reached)};
}

Platform three_axis() {
  Platform p;
  p.name = "three_axis";
  p.limits = three_axis_limits();
  p.legs = three_legs();
  return p;
}

Platform three_axis_measured() {
  Platform p = three_axis();
  p.name = "three_axis_measured";
  // Tables of the platform whose experiments are reproduced, static tilt commanded and reached.
  p.reach[PlatformAxis::kPitch] = in_degrees({-20.0, -17.0, -15.0, -10.0, 0.0, 10.0, 15.0, 20.0, 22.0, 24.0, 26.0},
                                             {-15.5, -15.5, -14.0, -9.0, 0.0, 9.0, 14.0, 18.5, 20.0, 22.0, 21.5});
  p.reach[PlatformAxis::kRoll] =
      in_degrees({0.0, 10.0, 15.0, 17.0, 19.0, 20.0, 22.0, 23.0}, {0.0, 9.0, 15.0, 16.0, 19.5, 20.0, 20.0, 20.5});
  StaticReach& roll = p.reach[PlatformAxis::kRoll];  // measured to the right; the same to the left
  for (std::size_t i = 1, n = roll.commanded.size(); i < n; ++i) {
    roll.commanded.insert(roll.commanded.begin(), -roll.commanded[2 * i - 1]);
    roll.reached.insert(roll.reached.begin(), -roll.reached[2 * i - 1]);
  }
  return p;
}

Platform hexapod() {
  Platform p;
  p.name = "hexapod";
  p.limits = hexapod_limits();
  p.legs = six_legs();
  return p;
}

Platform ideal() {
  Platform p;
  p.name = "ideal";
  for (const PlatformAxis axis : kAllPlatformAxes) {
    const double range = turns(axis) ? 60.0 * kDegree : 10.0;
    p.limits[axis] = {.lowest = -range, .highest = range, .rate = 1e2, .acceleration = 1e4, .jerk = 1e7};
  }
  p.actuators = {.omega = 0.0, .zeta = 1.0, .delay = 0.0};
  return p;
}

std::vector<Eigen::Vector3d> places(const StudyTable& table, std::string_view key) {
  const std::vector<double> values = table.numbers(key, "m");
  if (values.size() % 3 != 0) table.fail(key, fmt::format("has {} numbers; takes three a leg", values.size()));
  std::vector<Eigen::Vector3d> all;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) all.emplace_back(values[i], values[i + 1], values[i + 2]);
  return all;
}

void read_legs(const StudyTable& table, Platform& p) {
  if (table.has("legs") && table.text("legs") == "none") {
    p.legs.reset();
    return;
  }
  if (table.has("legs")) table.fail("legs", "is none or not given; `feet` and `heads` say where legs are");
  if (table.has("feet") && !p.legs) p.legs = LegGeometry{};
  if (!p.legs) return;
  if (table.has("feet")) p.legs->feet = places(table, "feet");
  if (table.has("heads")) p.legs->heads = places(table, "heads");
  if (table.has("leg_stroke")) {
    const std::vector<double> range = table.numbers("leg_stroke", "m");
    if (range.size() != 2) table.fail("leg_stroke", "takes the shortest and the longest length against neutral");
    p.legs->leg.lowest = range[0];
    p.legs->leg.highest = range[1];
  }
  p.legs->leg.rate = table.positive_or("leg_rate", "m/s", p.legs->leg.rate);
  p.legs->leg.acceleration = table.positive_or("leg_acceleration", "m/s^2", p.legs->leg.acceleration);
  p.legs->leg.jerk = table.positive_or("leg_jerk", "m/s^3", 25.0 * p.legs->leg.acceleration);
}

void read_reach(const StudyTable& table, PlatformAxis axis, StaticReach& reach) {
  const std::string commanded = fmt::format("{}_commanded", name_of(axis)),
                    reached = fmt::format("{}_reached", name_of(axis));
  if (!table.has(commanded) && !table.has(reached)) return;
  const char* unit = turns(axis) ? "rad" : "m";
  reach = {table.numbers(commanded, unit), table.numbers(reached, unit)};
  if (reach.commanded.size() < 2 || reach.commanded.size() != reach.reached.size())
    table.fail(reached, fmt::format("has {} values for {} commands; takes as many, two at least", reach.reached.size(),
                                    reach.commanded.size()));
  if (!std::is_sorted(reach.commanded.begin(), reach.commanded.end(), std::less_equal<>()))
    table.fail(commanded, "must grow from each value to the next");
}

void read_response(const StudyTable& table, const std::string& before, ActuatorOptions& a) {
  a.omega = table.number_or(before + "omega", "rad/s", a.omega);
  a.zeta = table.positive_or(before + "zeta", "1", a.zeta);
  a.delay = table.number_or(before + "delay", "s", a.delay);
}

void validate_response(const std::string& before, const ActuatorOptions& a) {
  if (!(a.omega >= 0.0) || !std::isfinite(a.omega))
    throw InputError(before + "omega", fmt::format("is {}; must be above 0", a.omega));
  constexpr double kMostDelay = 0.5;
  if (!(a.delay >= 0.0 && a.delay < kMostDelay))
    throw InputError(before + "delay", fmt::format("is {} s; takes 0 to {} s", a.delay, kMostDelay));
  if (a.omega == 0.0 && a.delay > 0.0)
    throw InputError(before + "delay", "of a platform that follows at once (omega = 0) must be 0");
  if (!(a.zeta > 0.0)) throw InputError(before + "zeta", fmt::format("is {}; must be above 0", a.zeta));
}

}  // namespace

StaticReach::Point StaticReach::at(double command) const {
  if (empty()) return {command, 1.0};
  const auto above = std::upper_bound(commanded.begin(), commanded.end(), command);
  if (above == commanded.begin()) return {reached.front(), 0.0};
  if (above == commanded.end()) return {reached.back(), 0.0};
  const auto i = static_cast<std::size_t>(above - commanded.begin());
  const double slope = (reached[i] - reached[i - 1]) / (commanded[i] - commanded[i - 1]);
  return {reached[i - 1] + slope * (command - commanded[i - 1]), slope};
}

Platform Platform::read(const StudyTable& table) {
  Platform p;
  p.name = "own";
  if (table.has("file")) {
    if (table.has("subject")) table.fail("subject", "is given as well as `file`: give one of them");
    p = read_platform_file(table.file("file"));
  }
  if (table.has("subject")) {
    std::vector<std::string> names;
    for (const Platform& known : built_in_platforms()) names.push_back(known.name);
    p = built_in_platform(table.choice_or("subject", names, ""));
  }
  p.name = table.text_or("name", p.name);
  p.limits.read_over(table);
  read_legs(table, p);
  read_response(table, "", p.actuators);
  for (const PlatformAxis axis : kAllPlatformAxes) {
    const std::string before = fmt::format("{}_", name_of(axis));
    const bool own = table.has(before + "omega") || table.has(before + "zeta") || table.has(before + "delay");
    if (own && !p.axis_actuators[axis]) p.axis_actuators[axis] = p.actuators;
    if (own) read_response(table, before, *p.axis_actuators[axis]);
  }
  for (const PlatformAxis axis : kAllPlatformAxes) read_reach(table, axis, p.reach[axis]);
  if (table.has("rider")) {
    const std::vector<double> place = table.numbers("rider", "m");
    if (place.size() != 3) table.fail("rider", "takes three numbers: forward, right, down");
    p.rider = {place[0], place[1], place[2]};
  }
  p.validate();
  return p;
}

void Platform::validate() const {
  limits.validate();
  validate_response("platform.", actuators);
  for (const PlatformAxis axis : kAllPlatformAxes) {
    if (axis_actuators[axis]) validate_response(fmt::format("platform.{}_", name_of(axis)), *axis_actuators[axis]);
  }
  if (!rider.allFinite()) throw InputError("platform.rider", "is not finite");
  if (legs) static_cast<void>(Legs(*legs, limits));
}

const std::vector<Platform>& built_in_platforms() {
  static const std::vector<Platform> all = {three_axis(), three_axis_measured(), hexapod(), ideal()};
  return all;
}

const Platform& built_in_platform(std::string_view name) {
  std::vector<std::string> names;
  for (const Platform& p : built_in_platforms()) {
    if (p.name == name) return p;
    names.push_back(p.name);
  }
  throw InputError("platform", fmt::format("there is no built-in platform '{}'{}", name, suggestion(name, names)));
}

}  // namespace veridyn::cueing
