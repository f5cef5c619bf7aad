#include "veridyn/vehicle/identification/options/vehicle_identify_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "veridyn/estimation/uncertainty/profile_choice.hpp"

namespace veridyn::vehicle {
namespace {

/// Nothing for "auto".
std::optional<DriveEffects> read_effects(const StudyTable& table) {
  if (!table.has("effects") || (table.is_text("effects") && table.text("effects") == "auto")) return std::nullopt;
  DriveEffects effects{};
  for (const std::string& name : table.texts("effects")) {
    const auto at = std::ranges::find(kDriveEffectNames, name);
    if (at == kDriveEffectNames.end()) {
      const std::vector<std::string> names(kDriveEffectNames.begin(), kDriveEffectNames.end());
      table.fail("effects", fmt::format("names '{}', which is none of {}", name, fmt::join(names, ", ")));
    }
    effects[static_cast<DriveEffect>(at - kDriveEffectNames.begin())] = true;
  }
  return effects;
}

}  // namespace

VehicleIdentifyOptions VehicleIdentifyOptions::read(const StudyTable& table) {
  VehicleIdentifyOptions o;
  o.equation_error = table.flag_or("equation_error", o.equation_error);
  o.output_error = table.flag_or("output_error", o.output_error);
  if (!o.equation_error && !o.output_error)
    table.fail("output_error", "and equation_error are both false: nothing is left to identify by");
  std::vector<std::string> methods{"auto"};
  for (const VehicleMethod m : {VehicleMethod::kOutputError, VehicleMethod::kOls, VehicleMethod::kTls,
                                VehicleMethod::kGtls, VehicleMethod::kPcaGtls})
    methods.emplace_back(to_string(m));
  const std::string method = table.choice_or("method", methods, "auto");
  if (method != "auto") o.method = vehicle_method(method);
  o.model.read_keys(table);
  std::vector<std::string> structures{"auto"};
  structures.insert(structures.end(), kDriveStructureNames.begin(), kDriveStructureNames.end());
  const std::string structure = table.choice_or("structure", structures, "auto");
  const auto at = std::ranges::find(kDriveStructureNames, structure);
  if (at != kDriveStructureNames.end()) {
    o.structure = static_cast<DriveStructure>(at - kDriveStructureNames.begin());
    o.model = with_structure(o.model, *o.structure);
  }
  o.effects = read_effects(table);
  if (o.effects) o.model = with_effects(o.model, *o.effects);
  std::vector<std::string> free;
  for (std::size_t i = 0; i < kDriveUnknowns; ++i)
    if (o.model.free[i]) free.emplace_back(kDriveUnknownNames[i]);
  o.profiles = estimation::read_profiles(table, free);
  if (!o.profiles.empty() && !o.output_error)
    table.fail("profiles", "are of the output error, which output_error = false leaves out");
  o.signal_to_noise = table.number_or("signal_to_noise", "1", o.signal_to_noise);
  if (!(o.signal_to_noise >= 1.0 && o.signal_to_noise <= 10.0))
    table.fail("signal_to_noise", fmt::format("= {} must be from 1 to 10", o.signal_to_noise));
  o.significance = table.number_or("significance", "1", o.significance);
  if (!(o.significance > 0.0 && o.significance < 1.0))
    table.fail("significance", fmt::format("= {} must be between 0 and 1", o.significance));
  o.min_holdout_r2 = table.number_or("min_holdout_r2", "1", o.min_holdout_r2);
  o.max_unmodelled = table.number_or("max_unmodelled", "1", o.max_unmodelled);
  o.contradiction_level = table.number_or("contradiction_level", "1", o.contradiction_level);
  o.max_relative_sigma = table.positive_or("max_relative_sigma", "1", o.max_relative_sigma);
  const StudyTable known = table.table_or_empty("uncertainty");
  const auto sigma = [&](const char* key, const char* unit) {
    const double s = known.number_or(key, unit, 0.0);
    if (!(s >= 0.0)) known.fail(key, fmt::format("= {:g} must be >= 0: it is a standard deviation", s));
    return s;
  };
  o.mass_sigma = sigma("mass", "kg");
  o.a_sigma = sigma("a", "m");
  o.b_sigma = sigma("b", "m");
  return o;
}

}  // namespace veridyn::vehicle
