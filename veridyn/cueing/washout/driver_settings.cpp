#include "veridyn/cueing/washout/driver_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace veridyn::cueing {
namespace {

struct Setting {
  const char* name;
  std::optional<double> DriverSettings::*value;
  double least, most;
};

constexpr Setting kSettings[] = {{"overall", &DriverSettings::overall, 0.0, 100.0},
                                 {"sustained", &DriverSettings::sustained, 0.0, 2.0},
                                 {"instant", &DriverSettings::instant, 0.0, 1.0},
                                 {"chassis", &DriverSettings::chassis, 0.0, 20.0},
                                 {"aggression", &DriverSettings::aggression, 0.1, 20.0}};
constexpr double kWholeChassis = 20.0;

}  // namespace

DriverSettings DriverSettings::preset(std::string_view name) {
  const double overall = name == "low" ? 30.0 : name == "medium" ? 68.0 : 100.0;
  return {.overall = overall, .sustained = 0.45, .instant = 0.15, .chassis = 6.0, .aggression = 4.4};
}

DriverSettings DriverSettings::read(const StudyTable& table) {
  DriverSettings s;
  const std::vector<std::string> presets = {"low", "medium", "high"};
  if (table.has("preset")) s = preset(table.choice_or("preset", presets, ""));
  for (const Setting& setting : kSettings) {
    const std::optional<double> given = table.optional_number(setting.name, "1");
    if (!given) continue;
    if (!(*given >= setting.least && *given <= setting.most))
      table.fail(setting.name, fmt::format("is {:g}; takes {:g} to {:g}", *given, setting.least, setting.most));
    s.*setting.value = given;
  }
  return s;
}

void DriverSettings::apply(WashoutDesign& design) const {
  const auto set = [](const Knob& knob, double value) { std::fill(knob.values.begin(), knob.values.end(), value); };
  for (const Knob& knob : design.knobs()) {
    const bool gain =
        knob.name == "force_gain" || knob.name == "rate_gain" || knob.name == "heave_gain" || knob.name == "yaw_gain";
    if (gain && overall) set(knob, *overall / 100.0);
    if (knob.name == "rate_gain" && chassis) {
      for (std::size_t i = 0; i < std::min<std::size_t>(2, knob.values.size()); ++i)
        knob.values[i] = overall.value_or(100.0) / 100.0 * *chassis / kWholeChassis;
    }
    if (knob.name == "sustained" && sustained) set(knob, *sustained);
    if (knob.name == "instant" && instant) set(knob, *instant);
    if (knob.name == "tilt" && aggression) set(knob, *aggression);
  }
}

}  // namespace veridyn::cueing
