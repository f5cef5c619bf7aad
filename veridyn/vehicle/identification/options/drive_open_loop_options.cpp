#include "veridyn/vehicle/identification/options/drive_open_loop_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "veridyn/core/nearest.hpp"

namespace veridyn::vehicle {

DriveOpenLoopOptions DriveOpenLoopOptions::read(const StudyTable& table) {
  DriveOpenLoopOptions options;
  options.times = estimation::OpenLoopTimes::read(table);
  if (!table.has("open_loop_offsets")) return options;
  std::vector<std::string> names;
  for (const DriveUnknown bias : kDriveBiases) names.emplace_back(kDriveUnknownNames[bias]);
  options.offsets.emplace();
  for (const std::string& name : table.texts("open_loop_offsets")) {
    const auto found = std::ranges::find(names, name);
    if (found == names.end())
      table.fail("open_loop_offsets",
                 fmt::format("'{}' is no bias of steering or sensors{}", name, suggestion(name, names, names.size())));
    options.offsets->push_back(kDriveBiases[found - names.begin()]);
  }
  return options;
}

}  // namespace veridyn::vehicle
