#include "veridyn/cueing/platform/platform_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::cueing {
namespace {

constexpr PerPlatformAxis<std::string_view> kNames = {"surge", "sway", "heave", "roll", "pitch", "yaw"};

/// Jerk over acceleration where nothing else is known [1/s].
constexpr double kUsualJerk = 20.0;

AxisLimits symmetric(double position, double rate, double acceleration) {
  return {.lowest = -position,
          .highest = position,
          .rate = rate,
          .acceleration = acceleration,
          .jerk = kUsualJerk * acceleration};
}

}  // namespace

std::string_view name_of(PlatformAxis axis) { return kNames[axis]; }

KeyTable<AxisLimits> axis_keys(const std::string& name, const std::string& unit) {
  using L = AxisLimits;
  const auto per = [&](const char* time) { return unit.empty() ? fmt::format("m{0} or rad{0}", time) : unit + time; };
  const std::string rate = name + "_rate", acceleration = name + "_acceleration", jerk = name + "_jerk";
  return KeyTable<L>("platform")
      .other({name, per(""), "[lowest, highest], 0 between", "it cannot move", "positions against neutral", true},
             [unit](const StudyTable& t, const std::string& key, L& l) {
               const std::vector<double> range = internal::numbers_in(t, key, unit, kAnyNumber, 2);
               l.lowest = range[0];
               l.highest = range[1];
               if (!(l.lowest <= 0.0 && l.highest >= 0.0 && l.moves()))
                 t.fail(key, fmt::format("goes from {:g} to {:g} {}; the neutral position, 0, has to lie between",
                                         range[0], range[1], unit));
             })
      .number(rate, &L::rate, per("/s"), kPositive, "largest, either way")
      .otherwise("required of an axis that moves")
      .number(acceleration, &L::acceleration, per("/s^2"), kPositive, "largest, either way")
      .otherwise("required of an axis that moves")
      .number(jerk, &L::jerk, per("/s^3"), kPositive, "largest, either way")
      .otherwise("what reaches the acceleration in 50 ms")
      .check([=](const StudyTable& t, L& l) {
        std::vector<std::string> missing;
        for (const auto& [key, value] : {std::pair{rate, l.rate}, std::pair{acceleration, l.acceleration}}) {
          if (!l.moves() && t.has(key)) t.fail(key, fmt::format("is of an axis that cannot move: {} is missing", name));
          if (l.moves() && value == 0.0) missing.push_back(key);
        }
        if (!missing.empty())
          t.fail(missing.front(),
                 missing.size() == 1 ? "is missing" : fmt::format("is missing, and so is {}", missing.back()));
        if (!t.has(jerk) && (t.has(acceleration) || l.jerk == 0.0)) l.jerk = kUsualJerk * l.acceleration;
      });
}

void PlatformLimits::read_over(const StudyTable& table) {
  for (const PlatformAxis axis : kAllPlatformAxes) {
    constexpr AxisLimits kNotKnown{.rate = 0.0, .acceleration = 0.0, .jerk = 0.0};
    AxisLimits limits = axes[axis].moves() ? axes[axis] : kNotKnown;
    axis_keys(std::string(name_of(axis)), turns(axis) ? "rad" : "m").read(table, limits);
    if (limits.moves()) axes[axis] = limits;
  }
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
