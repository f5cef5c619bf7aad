#include "veridyn/vehicle/identification/options/vehicle_identify_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "veridyn/core/study_keys.hpp"
#include "veridyn/estimation/uncertainty/profile_choice.hpp"
#include "veridyn/vehicle/identification/options/drive_budget.hpp"

namespace veridyn::vehicle {
namespace {

using O = VehicleIdentifyOptions;

/// Nothing for "auto".
void read_effects(const StudyTable& table, const std::string& key, O& options) {
  if (table.is_text(key) && table.text(key) == "auto") return;
  options.effects.emplace();
  for (const std::string& name : table.texts(key)) {
    const auto at = std::ranges::find(kDriveEffectNames, name);
    if (at == kDriveEffectNames.end()) {
      const std::vector<std::string> names(kDriveEffectNames.begin(), kDriveEffectNames.end());
      table.fail(key, fmt::format("names '{}', which is none of {}", name, fmt::join(names, ", ")));
    }
    (*options.effects)[static_cast<DriveEffect>(at - kDriveEffectNames.begin())] = true;
  }
}

const KeyTable<GivenVehicleSigma>& given_sigma_keys() {
  using S = GivenVehicleSigma;
  static const auto table =
      KeyTable<S>(
          "uncertainty",
          "How well what is taken as known is known, as standard deviations. Motion alone shows only the ratios "
          "C_f/m, C_r/m and I_z/m; what else the error bars hold comes from here.")
          .number("mass", &S::mass, "kg", kNotNegative, "of the whole vehicle")
          .number("a", &S::a, "m", kNotNegative, "of the distance to the front axle")
          .number("b", &S::b, "m", kNotNegative, "of the distance to the rear axle")
          .number(
              "steer_scale", &S::steer_scale, "", kNotNegative,
              "of the recorded over the true steering, whose gear ratio differs between centre and lock; 0 where it "
              "was calibrated, or simulated");
  return table;
}

/// What structure, effects and profiles make of the model, after all keys.
void complete(const StudyTable& table, O& o) {
  if (!o.equation_error && !o.output_error)
    table.fail("output_error", "and equation_error are both false: nothing is left to identify by");
  if (o.structure) o.model = with_structure(o.model, *o.structure);
  if (o.effects) o.model = with_effects(o.model, *o.effects);
  std::vector<std::string> free;
  for (const DriveUnknown u : kAllDriveUnknowns)
    if (o.model.free[u] && !is_in_budget(u)) free.emplace_back(kDriveUnknownNames[u]);
  o.profiles = estimation::read_profiles(table, free);
  if (!o.profiles.empty() && !o.output_error)
    table.fail("profiles", "are of the output error, which output_error = false leaves out");
}

}  // namespace

const KeyTable<VehicleIdentifyOptions>& VehicleIdentifyOptions::keys() {
  static const auto table =
      KeyTable<O>("identify", "How the vehicle is identified, and what is demanded of the result.")
          .flag("equation_error", &O::equation_error, "regressions of the equations of motion")
          .flag("output_error", &O::output_error, "maximum likelihood of the simulated outputs")
          .choice("method", &O::method,
                  {{"auto", {}},
                   {"output error", VehicleMethod::kOutputError},
                   {"OLS", VehicleMethod::kOls},
                   {"TLS", VehicleMethod::kTls},
                   {"GTLS", VehicleMethod::kGtls},
                   {"PCA-GTLS", VehicleMethod::kPcaGtls}},
                  "whose parameters count; `auto`: output error where it converged, else the regression that the "
                  "comparison recommends")
          .choice("structure", &O::structure,
                  choices_of<std::optional<DriveStructure>>(kDriveStructureNames, {{"auto", {}}}),
                  "what moves and how tyres give; `auto`: the richest that the drive determines and asks for")
          .other(
              {"effects", "",
               "`\"auto\"`, or a list of " + quoted_list({kDriveEffectNames.begin(), kDriveEffectNames.end()}, "`"),
               "\"auto\"",
               "what road, air and pedals add; `auto`: what the drive tells and asks for, nothing beside a structure "
               "that is given"},
              read_effects)
          .with(&O::model, DriveModelOptions::keys())
          .other({"profiles", "", "`true`, or a list of unknowns", "false",
                  "unknowns whose profile likelihood is followed, by output error; `true`: all that are estimated"},
                 [](const StudyTable&, const std::string&, O&) {})
          .number("signal_to_noise", &O::signal_to_noise, "1", from_to(1.0, 10.0), "S/n of the excitation threshold")
          .number("significance", &O::significance, "1", between(0.0, 1.0), "level of the t-tests")
          .number("min_holdout_r2", &O::min_holdout_r2, "1", kAnyNumber,
                  "of the predicted yaw rate; below it everything is rejected")
          .number("max_unmodelled", &O::max_unmodelled, "1", kAnyNumber,
                  "largest share of an output's power that may be left as autocorrelated residual")
          .number("contradiction_level", &O::contradiction_level, "1", kAnyNumber,
                  "p below which methods or parts of the data contradict each other")
          .number("max_relative_sigma", &O::max_relative_sigma, "1", kPositive,
                  "a stiffness or inertia whose standard error is a larger share of it is not excited")
          .table("uncertainty", &O::given, given_sigma_keys())
          .check(complete);
  return table;
}

}  // namespace veridyn::vehicle
