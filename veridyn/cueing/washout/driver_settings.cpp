#include "veridyn/cueing/washout/driver_settings.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "veridyn/core/study_keys.hpp"

namespace veridyn::cueing {
namespace {

constexpr double kWholeChassis = 20.0;

}  // namespace

DriverSettings DriverSettings::preset(std::string_view name) {
  const double overall = name == "low" ? 30.0 : name == "medium" ? 68.0 : 100.0;
  return {.overall = overall, .sustained = 0.45, .instant = 0.15, .chassis = 6.0, .aggression = 4.4};
}

const KeyTable<DriverSettings>& DriverSettings::keys() {
  using S = DriverSettings;
  static const std::vector<std::string> presets = {"low", "medium", "high"};
  static const char* const kOwn = "each algorithm's own knobs";
  static const auto table =
      KeyTable<S>("cue")
          .other({"preset", "", quoted_list(presets, "`"), "none",
                  "overall 30, 68, 100; sustained 0.45, instant 0.15, chassis 6, aggression 4.4", true},
                 [](const StudyTable& t, const std::string& key, S& s) { s = preset(t.choice_or(key, presets, "")); })
          .number("overall", &S::overall, "1", from_to(0.0, 100.0), "all gains, in percent of the vehicle's motion")
          .otherwise(kOwn)
          .number("sustained", &S::sustained, "1", from_to(0.0, 2.0), "share of lasting forces: `sustained`")
          .otherwise(kOwn)
          .number("instant", &S::instant, "1", from_to(0.0, 1.0), "share of their beginnings: `instant`")
          .otherwise(kOwn)
          .number("chassis", &S::chassis, "1", from_to(0.0, kWholeChassis),
                  "`rate_gain` of roll and pitch, 20 being the vehicle's own times `overall`")
          .otherwise(kOwn)
          .number("aggression", &S::aggression, "1", from_to(0.1, 20.0), "`tilt` [rad/s]: how fast filters follow")
          .otherwise(kOwn);
  return table;
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
