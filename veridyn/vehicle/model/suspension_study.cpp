#include "veridyn/vehicle/model/suspension_study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string_view>

namespace veridyn::vehicle {

std::string write_suspension_toml(const AxleSuspension& front, const AxleSuspension& rear,
                                  const AerodynamicLift& lift) {
  std::string text;
  const auto number = [&](std::string_view name, double value) {
    if (value != 0.0) text += fmt::format("{} = {}\n", name, value);
  };
  for (const char suffix : {'f', 'r'}) {
    const AxleSuspension& axle = suffix == 'f' ? front : rear;
    number(fmt::format("roll_centre_{}", suffix), axle.roll_centre);
    number(fmt::format("roll_steer_{}", suffix), axle.roll_steer);
    number(fmt::format("bump_steer_{}", suffix), axle.bump_steer);
    number(fmt::format("compliance_steer_{}", suffix), axle.compliance_steer);
    if (axle.spring.empty()) continue;
    text += fmt::format("travel_{} = [{}]\nforce_{} = [{}]\n", suffix, fmt::join(axle.spring.travels(), ", "), suffix,
                        fmt::join(axle.spring.forces(), ", "));
  }
  std::string all = text.empty() ? "" : "[subject.suspension]\n" + text;
  text.clear();
  number("lift_area_f", lift.area_f);
  number("lift_area_r", lift.area_r);
  if (!text.empty()) all += fmt::format("[subject.aerodynamics]\nair_density = {}\n", lift.air_density) + text;
  return all;
}

}  // namespace veridyn::vehicle
