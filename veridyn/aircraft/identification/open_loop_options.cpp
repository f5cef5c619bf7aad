#include "veridyn/aircraft/identification/open_loop_options.hpp"

#include <fmt/format.h>

#include <string>

#include "veridyn/core/nearest.hpp"

namespace veridyn::aircraft {

OpenLoopOptions OpenLoopOptions::read(const StudyTable& table) {
  OpenLoopOptions options;
  options.duration_s = table.positive_or("open_loop", "s", options.duration_s);
  options.start_s = table.positive_or("open_loop_start", "s", options.start_s);
  if (options.asked() && !(options.duration_s > options.start_s))
    table.fail("open_loop", fmt::format("= {} s must be longer than open_loop_start = {} s, from which the initial "
                                        "state is estimated",
                                        options.duration_s, options.start_s));
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
