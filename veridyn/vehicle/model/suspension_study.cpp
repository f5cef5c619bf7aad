#include "veridyn/vehicle/model/suspension_study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string_view>
#include <utility>
#include <vector>

#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {

AxleSuspension read_axle_suspension(const StudyTable& table, char suffix, const AxleSuspension& otherwise) {
  const auto key = [suffix](const char* name) { return fmt::format("{}_{}", name, suffix); };
  AxleSuspension axle = otherwise;
  axle.roll_centre = table.number_or(key("roll_centre"), "m", axle.roll_centre);
  axle.roll_steer = table.number_or(key("roll_steer"), "rad/rad", axle.roll_steer);
  axle.bump_steer = table.number_or(key("bump_steer"), "rad/m", axle.bump_steer);
  axle.compliance_steer = table.number_or(key("compliance_steer"), "rad/N", axle.compliance_steer);
  if (table.has(key("travel")) || table.has(key("force"))) {
    std::vector<double> travel = table.numbers(key("travel"), "m"), force = table.numbers(key("force"), "N");
    try {
      axle.spring = SpringCurve(std::move(travel), std::move(force));
    } catch (const InputError& wrong) {
      table.fail(key("force"), std::string_view(wrong.what()).substr(wrong.place().size() + 2));
    }
  }
  if (const std::string why = inadmissible(axle, suffix); !why.empty())
    throw InputError(table.place(why.substr(0, why.find(' '))), why);
  return axle;
}

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
