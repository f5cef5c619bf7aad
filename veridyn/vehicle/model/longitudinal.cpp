#include "veridyn/vehicle/model/longitudinal.hpp"

#include <fmt/format.h>

#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::vehicle {

std::string inadmissible(const LongitudinalParameters& p) {
  struct Range {
    const char* name;
    double value;
    bool zero_is_well;
    double most;
    const char* rule;
  };
  const Range ranges[] = {
      {"front_drive_share", p.front_drive_share, true, 1.0, "between 0 and 1"},
      {"front_brake_share", p.front_brake_share, true, 1.0, "between 0 and 1"},
      {"wheel_radius", p.wheel_radius, false, kInfinity, "> 0"},
      {"wheel_inertia", p.wheel_inertia, false, kInfinity, "> 0"},
      {"drag_area", p.drag_area, true, kInfinity, ">= 0"},
      {"air_density", p.air_density, true, kInfinity, ">= 0"},
      {"rolling_resistance", p.rolling_resistance, true, 1.0, "between 0 and 1"},
  };
  for (const Range& r : ranges) {
    const bool large_enough = r.zero_is_well ? r.value >= 0.0 : r.value > 0.0;
    if (!(large_enough && r.value <= r.most && r.value < kInfinity)) {
      return fmt::format("{} is {:g}; must be {}", r.name, r.value, r.rule);
    }
  }
  if (!(std::abs(p.grade) <= 0.5)) return fmt::format("grade is {:g} rad; must be between -0.5 and 0.5", p.grade);
  return {};
}

}  // namespace veridyn::vehicle
