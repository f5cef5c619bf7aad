#include "veridyn/cueing/platform/platform.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/cueing/platform/platform_file.hpp"

namespace veridyn::cueing {
namespace {

constexpr double kMostDelay = 0.5;  // [s]

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

/// A list of places, three numbers each.
auto places(std::vector<Eigen::Vector3d> LegGeometry::*field) {
  return [field](const StudyTable& t, const std::string& key, LegGeometry& legs) {
    const std::vector<double> values = t.numbers(key, "m");
    if (values.size() % 3 != 0) t.fail(key, fmt::format("has {} numbers; takes three a leg", values.size()));
    (legs.*field).clear();
    for (std::size_t i = 0; i + 2 < values.size(); i += 3)
      (legs.*field).emplace_back(values[i], values[i + 1], values[i + 2]);
  };
}

const KeyTable<LegGeometry>& leg_keys() {
  using G = LegGeometry;
  static const char* const kOfSubject = "of a subject its own";
  static const auto limit = [](double AxisLimits::*of) { return [of](G& g) -> double& { return g.leg.*of; }; };
  static const auto table =
      KeyTable<G>("platform")
          .other({"feet", "m", "numbers in threes", kOfSubject,
                  "lower ends of the legs: forward, right, down of the centre of rotation at neutral", true},
                 places(&G::feet))
          .other({"heads", "m", "numbers in threes", kOfSubject, "upper ends, from that centre", true},
                 places(&G::heads))
          .other({"leg_stroke", "m", "[shortest, longest]", kOfSubject, "lengths against neutral", true},
                 [](const StudyTable& t, const std::string& key, G& g) {
                   const std::vector<double> range = internal::numbers_in(t, key, "m", kAnyNumber, 2);
                   g.leg.lowest = range[0];
                   g.leg.highest = range[1];
                 })
          .number("leg_rate", limit(&AxisLimits::rate), "m/s", kPositive, "largest of a leg")
          .number("leg_acceleration", limit(&AxisLimits::acceleration), "m/s^2", kPositive, "largest of a leg")
          .number("leg_jerk", limit(&AxisLimits::jerk), "m/s^3", kPositive, "largest of a leg")
          .otherwise("what reaches the acceleration in 40 ms")
          .check([](const StudyTable& t, G& g) {
            if (!t.has("leg_jerk")) g.leg.jerk = 25.0 * g.leg.acceleration;
          });
  return table;
}

void read_legs(const StudyTable& table, Platform& p) {
  if (table.has("legs") && table.text("legs") == "none") {
    p.legs.reset();
    return;
  }
  if (table.has("legs")) table.fail("legs", "is none or not given; `feet` and `heads` say where legs are");
  if (table.has("feet") && !p.legs) p.legs = LegGeometry{};
  if (p.legs) leg_keys().read(table, *p.legs);
}

/// Of an axis, or of both kinds where the unit is empty.
KeyTable<StaticReach> reach_keys(const std::string& axis, const std::string& unit) {
  const std::string commanded = axis + "_commanded", reached = axis + "_reached",
                    shown = unit.empty() ? "m or rad" : unit;
  return KeyTable<StaticReach>("platform")
      .numbers(commanded, &StaticReach::commanded, shown, kAnyNumber, "commands, growing, two at least")
      .otherwise("none")
      .numbers(reached, &StaticReach::reached, shown, kAnyNumber, "where the axis comes to rest at each")
      .otherwise("it comes to rest where it is commanded")
      .check([=](const StudyTable& t, StaticReach& reach) {
        if (!t.has(commanded) && !t.has(reached)) return;
        if (reach.commanded.size() < 2 || reach.commanded.size() != reach.reached.size())
          t.fail(reached, fmt::format("has {} values for {} commands; takes as many, two at least",
                                      reach.reached.size(), reach.commanded.size()));
        if (!std::is_sorted(reach.commanded.begin(), reach.commanded.end(), std::less_equal<>()))
          t.fail(commanded, "must grow from each value to the next");
      });
}

/// Of all actuators, or with `axis` before them of an axis.
KeyTable<ActuatorOptions> response_keys(const std::string& axis) {
  using A = ActuatorOptions;
  return KeyTable<A>("platform")
      .number(axis + "omega", &A::omega, "rad/s", kNotNegative,
              "natural frequency with which commands are followed; 0: at once")
      .number(axis + "zeta", &A::zeta, "1", kPositive, "damping ratio")
      .number(axis + "delay", &A::delay, "s", {.low = 0.0, .high = kMostDelay, .with_high = false},
              "before the actuators begin to follow");
}

/// Keys that are not by axis.
const KeyTable<Platform>& own_keys() {
  static const auto table =
      KeyTable<Platform>("platform", "A platform built in, of a file or of its own numbers;")
          .elsewhere({"subject", "", "`three_axis`, `three_axis_measured`, `hexapod`, `ideal`", "none",
                      "a built-in one", true})
          .elsewhere({"file", "", "a file", "none", "or one that `veridyn rig test` has measured", true})
          .text("name", &Platform::name, "for reports")
          .otherwise("the subject's")
          .numbers("rider", &Platform::rider, "m", kAnyNumber,
                   "the rider's head from the centre of rotation: forward, right, down")
          .elsewhere({"legs", "", "`none`", "the subject's", "each axis has an actuator of its own", true});
  return table;
}

void validate_response(const std::string& before, const ActuatorOptions& a) {
  if (!(a.omega >= 0.0) || !std::isfinite(a.omega))
    throw InputError(before + "omega", fmt::format("is {}; must be above 0", a.omega));
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
  own_keys().read(table, p);
  p.limits.read_over(table);
  read_legs(table, p);
  response_keys("").read(table, p.actuators);
  for (const PlatformAxis axis : kAllPlatformAxes) {
    const std::string name(name_of(axis)), before = name + "_";
    const bool own = table.has(before + "omega") || table.has(before + "zeta") || table.has(before + "delay");
    if (own && !p.axis_actuators[axis]) p.axis_actuators[axis] = p.actuators;
    if (own) response_keys(before).read(table, *p.axis_actuators[axis]);
    reach_keys(name, turns(axis) ? "rad" : "m").read(table, p.reach[axis]);
  }
  p.validate();
  return p;
}

StudyKeys Platform::study_keys() {
  StudyKeys all = own_keys().described().front();
  const auto add = [&](const auto& table) {
    const std::vector<StudyKey> more = table.described().front().keys;
    all.keys.insert(all.keys.end(), more.begin(), more.end());
  };
  add(axis_keys("AXIS"));
  add(response_keys(""));
  const std::size_t of_all = all.keys.size();
  add(response_keys("AXIS_"));
  for (std::size_t i = of_all; i < all.keys.size(); ++i) {
    all.keys[i].otherwise = "that of all";
    all.keys[i].in_words = true;
  }
  add(reach_keys("AXIS", ""));
  add(leg_keys());
  all.about += " `AXIS`: `surge`, `sway`, `heave`, `roll`, `pitch`, `yaw`.";
  return all;
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
