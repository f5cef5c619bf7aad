#include "veridyn/cueing/platform/platform_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "veridyn/core/error.hpp"

namespace veridyn::cueing {
namespace {

constexpr PerPlatformAxis<std::string_view> kNames = {"surge", "sway", "heave", "roll", "pitch", "yaw"};

/// Jerk over acceleration where nothing else is known [1/s].
constexpr double kUsualJerk = 20.0;

void read_axis(const StudyTable& table, PlatformAxis axis, AxisLimits& limits) {
  const std::string name(name_of(axis)), unit = turns(axis) ? "rad" : "m";
  const bool known = limits.moves();
  if (table.has(name)) {
    const std::vector<double> range = table.numbers(name, unit);
    if (range.size() != 2) table.fail(name, fmt::format("has {} values; takes lowest and highest", range.size()));
    limits.lowest = range[0];
    limits.highest = range[1];
    if (!(limits.lowest <= 0.0 && limits.highest >= 0.0 && limits.highest > limits.lowest))
      table.fail(name, fmt::format("goes from {:g} to {:g} {}; the neutral position, 0, has to lie between", range[0],
                                   range[1], unit));
  }
  if (!limits.moves()) return;
  const auto limit = [&](const char* what, const char* per, std::optional<double> otherwise) {
    const std::string key = fmt::format("{}_{}", name, what);
    const double value = otherwise ? table.number_or(key, unit + per, *otherwise) : table.number(key, unit + per);
    if (!(value > 0.0)) table.fail(key, fmt::format("is {}; must be above 0", value));
    return value;
  };
  const auto otherwise = [known](double value) { return known ? std::optional(value) : std::nullopt; };
  const bool other = !known || table.has(name + "_acceleration");
  limits.rate = limit("rate", "/s", otherwise(limits.rate));
  limits.acceleration = limit("acceleration", "/s^2", otherwise(limits.acceleration));
  limits.jerk = limit("jerk", "/s^3", other ? kUsualJerk * limits.acceleration : limits.jerk);
}

AxisLimits symmetric(double position, double rate, double acceleration) {
  return {.lowest = -position,
          .highest = position,
          .rate = rate,
          .acceleration = acceleration,
          .jerk = kUsualJerk * acceleration};
}

}  // namespace

std::string_view name_of(PlatformAxis axis) { return kNames[axis]; }

PlatformLimits PlatformLimits::read(const StudyTable& table) {
  PlatformLimits limits;
  limits.read_over(table);
  return limits;
}

void PlatformLimits::read_over(const StudyTable& table) {
  for (const PlatformAxis axis : kAllPlatformAxes) read_axis(table, axis, axes[axis]);
  validate();
}

void PlatformLimits::validate() const {
  for (const PlatformAxis axis : kAllPlatformAxes) {
    const AxisLimits& a = axes[axis];
    if (!(a.lowest <= 0.0 && a.highest >= 0.0 && std::isfinite(a.highest - a.lowest)))
      throw InputError(
          fmt::format("platform.{}", kNames[axis]),
          fmt::format("goes from {:g} to {:g}; the neutral position, 0, has to lie between", a.lowest, a.highest));
    for (const double limit : {a.rate, a.acceleration, a.jerk}) {
      if (!(limit > 0.0) || !std::isfinite(limit))
        throw InputError(fmt::format("platform.{}", kNames[axis]),
                         fmt::format("has a limit of {:g}; rate, acceleration and jerk must be above 0", limit));
    }
  }
  if (moving_axes().empty())
    throw InputError("platform", "has no axis that moves; give roll = [-20, 20] deg and the like");
}

std::vector<PlatformAxis> PlatformLimits::moving_axes() const {
  std::vector<PlatformAxis> moving;
  for (const PlatformAxis axis : kAllPlatformAxes) {
    if (axes[axis].moves()) moving.push_back(axis);
  }
  return moving;
}

PlatformLimits three_axis_limits() {
  PlatformLimits limits;
  limits[PlatformAxis::kHeave] = symmetric(0.1, 0.3, 3.0);
  limits[PlatformAxis::kRoll] = symmetric(20.0 * kDegree, 30.0 * kDegree, 200.0 * kDegree);
  limits[PlatformAxis::kPitch] = limits[PlatformAxis::kRoll];
  limits[PlatformAxis::kPitch].lowest = -15.0 * kDegree;
  return limits;
}

PlatformLimits hexapod_limits() {
  PlatformLimits limits;
  for (const PlatformAxis axis : {PlatformAxis::kSurge, PlatformAxis::kSway}) limits[axis] = symmetric(0.5, 0.6, 6.0);
  limits[PlatformAxis::kHeave] = symmetric(0.4, 0.6, 6.0);
  for (const PlatformAxis axis : {PlatformAxis::kRoll, PlatformAxis::kPitch, PlatformAxis::kYaw})
    limits[axis] = symmetric(20.0 * kDegree, 35.0 * kDegree, 200.0 * kDegree);
  return limits;
}

}  // namespace veridyn::cueing
