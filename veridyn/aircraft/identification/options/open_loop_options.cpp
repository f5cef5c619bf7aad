#include "veridyn/aircraft/identification/options/open_loop_options.hpp"

#include <fmt/format.h>

#include <string>

#include "veridyn/core/nearest.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/estimation/open_loop/open_loop.hpp"

namespace veridyn::aircraft {

OpenLoopOptions OpenLoopOptions::read(const StudyTable& table) {
  OpenLoopOptions options;
  const estimation::OpenLoopTimes times = estimation::OpenLoopTimes::keys().read(table);
  options.duration_s = times.duration_s;
  options.start_s = times.start_s;
  if (table.has("open_loop_offsets")) {
    options.offsets.clear();
    const std::vector<std::string> names(kCoefficientNames.begin(), kCoefficientNames.end());
    for (const std::string& name : table.texts("open_loop_offsets")) {
      const std::optional<Coefficient> c = find_coefficient(name);
      if (!c)
        table.fail("open_loop_offsets", fmt::format("'{}' is not a coefficient{}", name, suggestion(name, names)));
      options.offsets.push_back(*c);
    }
  }
  if (table.has("open_loop_gusts")) options.gusts = table.flag_or("open_loop_gusts", false);
  return options;
}

}  // namespace veridyn::aircraft
