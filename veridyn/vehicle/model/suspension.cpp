#include "veridyn/vehicle/model/suspension.hpp"

#include <fmt/format.h>

#include <cmath>

namespace veridyn::vehicle {
namespace {

/// The first number beyond its limit, which lies far outside of what vehicles have: a wrong unit is meant to be found.
struct Limited {
  const char* name;
  double value, most;
  const char* unit;
};

}  // namespace

std::string inadmissible(const AxleSuspension& axle, char suffix) {
  const Limited numbers[] = {{"roll_centre", axle.roll_centre, 5.0, " m"},
                             {"roll_steer", axle.roll_steer, 2.0, " rad/rad"},
                             {"bump_steer", axle.bump_steer, 100.0, " rad/m"},
                             {"compliance_steer", axle.compliance_steer, 0.1, " rad/N"}};
  for (const auto& [name, value, most, unit] : numbers) {
    if (!(std::abs(value) <= most))
      return fmt::format("{}_{} is {:g}{}; must be between {:g} and {:g}", name, suffix, value, unit, -most, most);
  }
  return {};
}

std::string inadmissible(const AerodynamicLift& lift) {
  constexpr double kLargestLiftArea_m2 = 100.0;
  const Limited areas[] = {{"lift_area_f", lift.area_f, kLargestLiftArea_m2, " m^2"},
                           {"lift_area_r", lift.area_r, kLargestLiftArea_m2, " m^2"}};
  for (const auto& [name, value, most, unit] : areas) {
    if (!(std::abs(value) <= most))
      return fmt::format("{} is {:g}{}; must be between {:g} and {:g}", name, value, unit, -most, most);
  }
  if (!(lift.air_density >= 0.0 && lift.air_density <= 1e4))
    return fmt::format("air_density is {:g} kg/m^3; must be between 0 and 10000", lift.air_density);
  return {};
}

}  // namespace veridyn::vehicle
