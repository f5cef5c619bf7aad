// veridyn priors: what is taken of errors that are the same in all samples, before a recording says anything of them.
#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "apps/veridyn/run/console.hpp"
#include "veridyn/aircraft/identification/budget/sensor_priors.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/muscle/identification/emg_priors.hpp"
#include "veridyn/vehicle/identification/options/drive_budget.hpp"

namespace veridyn::app {
namespace {

/// One unknown; its mean is that of no error.
struct Prior {
  std::string key;  ///< of a study
  double sigma = 0.0;
  std::string unit, meaning, source;
};

std::vector<Prior> of_vehicle() {
  std::vector<Prior> priors;
  const auto add = [&](std::string_view table, const vehicle::DrivePrior& p) {
    priors.push_back({fmt::format("identify.{}.{}", table, vehicle::kDriveUnknownNames[p.unknown]), p.sigma,
                      std::string(vehicle::kDriveUnknownUnits[p.unknown]), std::string(p.meaning),
                      std::string(p.source)});
  };
  for (const vehicle::DrivePrior& p : vehicle::kDriveBudget) add("prior", p);
  add("uncertainty", vehicle::kSteerScalePrior);
  return priors;
}

std::vector<Prior> of_aircraft() {
  std::vector<Prior> priors;
  for (const aircraft::SensorPrior& p : aircraft::sensor_priors())
    priors.push_back(
        {fmt::format("sensors.{}.{}", aircraft::kBudgetSensorNames[p.sensor], aircraft::kSensorErrorKindNames[p.kind]),
         p.sigma, std::string(p.unit), std::string(aircraft::kSensorErrorKindMeanings[p.kind]), std::string(p.source)});
  return priors;
}

std::vector<Prior> of_muscle() {
  std::vector<Prior> priors;
  for (const muscle::EmgPrior& p : muscle::kEmgBudget)
    priors.push_back(
        {fmt::format("emg.{}", p.key), p.sigma, std::string(p.unit), std::string(p.meaning), std::string(p.source)});
  return priors;
}

const std::pair<std::string, std::vector<Prior> (*)()> kPriorsOf[] = {
    {"aircraft", of_aircraft}, {"vehicle", of_vehicle}, {"muscle", of_muscle}};

std::vector<Prior> priors_of(const std::string& kind) {
  std::vector<std::string> names;
  for (const auto& [name, priors] : kPriorsOf) {
    if (name == kind) return priors();
    names.push_back(name);
  }
  throw InputError("priors", fmt::format("there are none of '{}'{}", kind, suggestion(kind, names)));
}

int priors(const Arguments& arguments) {
  std::string text = "| unknown | meaning | standard deviation | source |\n| --- | --- | --- | --- |\n";
  Summary all = Summary::array();
  for (const Prior& p : priors_of(arguments.text("KIND"))) {
    text += fmt::format("| `{}` | {} | {:g}{} | {} |\n", p.key, p.meaning, p.sigma, p.unit == "1" ? "" : " " + p.unit,
                        p.source);
    all.push_back(Summary::object(
        {{"key", p.key}, {"meaning", p.meaning}, {"sigma", p.sigma}, {"unit", p.unit}, {"source", p.source}}));
  }
  if (arguments.common.json) {
    Summary summary = Summary::object();
    summary["priors"] = std::move(all);
    print_summary(summary, arguments.common);
  } else {
    print_text(text);
  }
  return kDone;
}

}  // namespace

Command priors_command() {
  std::string kinds;
  for (const auto& [name, priors] : kPriorsOf) kinds += (kinds.empty() ? "" : ", ") + name;
  return {
      .name = "priors",
      .summary = "what is taken of errors of sensors and models before a recording says anything of them",
      .arguments = {{.name = "KIND", .help = "what the study is about: " + kinds, .type = "TEXT", .required = true}},
      .example = "veridyn priors vehicle",
      .run = priors};
}

}  // namespace veridyn::app
