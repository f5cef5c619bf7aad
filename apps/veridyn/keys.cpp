// veridyn keys: the keys of studies, with units, defaults and what they may be.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "apps/veridyn/live/camera_run.hpp"
#include "apps/veridyn/run/console.hpp"
#include "veridyn/aircraft/aircraft_keys.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/cueing/cueing_keys.hpp"
#include "veridyn/live/rig/live_study.hpp"
#include "veridyn/muscle/muscle_keys.hpp"
#include "veridyn/vehicle/vehicle_keys.hpp"

namespace veridyn::app {
namespace {

/// What studies are about, as `veridyn init` calls it.
const std::pair<std::string, std::vector<StudyKeys> (*)()> kKinds[] = {{"vehicle", vehicle::study_keys},
                                                                       {"muscle", muscle::study_keys},
                                                                       {"cueing", cueing::study_keys},
                                                                       {"live", live::study_keys},
                                                                       {"camera", camera_keys},
                                                                       {"aircraft", aircraft::study_keys},
                                                                       {"swing-test", aircraft::swing_test_keys},
                                                                       {"calibration", aircraft::calibration_keys}};

std::vector<StudyKeys> keys_of(const std::string& kind) {
  std::vector<std::string> names;
  for (const auto& [name, tables] : kKinds) {
    if (name == kind) return tables();
    names.push_back(name);
  }
  throw InputError("keys", fmt::format("there are no studies of '{}', but of {}{}", kind, fmt::join(names, ", "),
                                       suggestion(kind, names)));
}

std::vector<StudyKeys> tables_named(std::vector<StudyKeys> all, const std::string& name) {
  if (name.empty()) return all;
  std::vector<std::string> names;
  for (const StudyKeys& one : all) names.push_back(one.table);
  std::erase_if(all, [&](const StudyKeys& one) { return one.table != name && !one.table.starts_with(name + '.'); });
  if (all.empty()) throw InputError("--table", fmt::format("there is no [{}]{}", name, suggestion(name, names)));
  return all;
}

int keys(const Arguments& arguments) {
  const std::vector<StudyKeys> tables = tables_named(keys_of(arguments.text("KIND")), arguments.text("--table"));
  std::string text;
  Summary all = Summary::array();
  for (const StudyKeys& one : tables) {
    text += (text.empty() ? "" : "\n") + in_markdown(one);
    Summary rows = Summary::array();
    for (const StudyKey& key : one.keys)
      rows.push_back(Summary::object({{"key", key.name},
                                      {"unit", key.unit},
                                      {"default", key.otherwise},
                                      {"values", key.range},
                                      {"meaning", key.says}}));
    Summary table = Summary::object({{"table", one.table}, {"about", one.about}});
    table["keys"] = std::move(rows);
    all.push_back(std::move(table));
  }
  if (arguments.common.json) {
    Summary summary = Summary::object();
    summary["tables"] = std::move(all);
    print_summary(summary, arguments.common);
  } else {
    print_text(text);
  }
  return kDone;
}

}  // namespace

Command keys_command() {
  std::string kinds;
  for (const auto& [name, tables] : kKinds) kinds += (kinds.empty() ? "" : ", ") + name;
  return {.name = "keys",
          .summary = "the keys of a study: units, defaults, what they may be and what they are for",
          .arguments = {{.name = "KIND", .help = "what the study is about: " + kinds, .type = "TEXT", .required = true},
                        {.name = "--table", .help = "only this table of it, such as identify", .type = "NAME"}},
          .example = "veridyn keys vehicle --table identify",
          .run = keys};
}

}  // namespace veridyn::app
