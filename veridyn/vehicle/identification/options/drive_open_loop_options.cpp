#include "veridyn/vehicle/identification/options/drive_open_loop_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "veridyn/core/nearest.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::vehicle {

namespace {

void read_offsets(const StudyTable& table, const std::string& key, DriveOpenLoopOptions& options) {
  std::vector<std::string> names;
  for (const DriveUnknown bias : kDriveBiases) names.emplace_back(kDriveUnknownNames[bias]);
  options.offsets.emplace();
  for (const std::string& name : table.texts(key)) {
    const auto found = std::ranges::find(names, name);
    if (found == names.end())
      table.fail(key,
                 fmt::format("'{}' is no bias of steering or sensors{}", name, suggestion(name, names, names.size())));
    options.offsets->push_back(kDriveBiases[found - names.begin()]);
  }
}

}  // namespace

const KeyTable<DriveOpenLoopOptions>& DriveOpenLoopOptions::keys() {
  using O = DriveOpenLoopOptions;
  static const auto table =
      KeyTable<O>("validate")
          .with(&O::times, estimation::OpenLoopTimes::keys())
          .other({"open_loop_offsets", "", "names of biases of steering and sensors",
                  "those that the estimate does not know of this drive; on another drive that is all",
                  "have a constant of their own in each window, estimated with the initial state: biases belong to the "
                  "day",
                  true},
                 read_offsets);
  return table;
}

const KeyTable<DriveValidateOptions>& DriveValidateOptions::keys() {
  using O = DriveValidateOptions;
  static const auto table = KeyTable<O>("validate", "Where and how an estimate is validated.")
                                .choice("segments", &O::holdout_only, {{"all", false}, {"holdout", true}},
                                        "stretches on which `veridyn validate` tests an estimate from other data")
                                .with(&O::open_loop, DriveOpenLoopOptions::keys());
  return table;
}

}  // namespace veridyn::vehicle
