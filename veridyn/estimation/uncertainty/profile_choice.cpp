#include "veridyn/estimation/uncertainty/profile_choice.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/nearest.hpp"

namespace veridyn::estimation {

std::vector<std::string> read_profiles(const StudyTable& table, std::span<const std::string> free) {
  if (!table.is_array("profiles"))
    return table.flag_or("profiles", false) ? std::vector<std::string>(free.begin(), free.end())
                                            : std::vector<std::string>();
  std::vector<std::string> names = table.texts("profiles");
  for (const std::string& name : names) {
    if (std::find(free.begin(), free.end(), name) == free.end())
      table.fail("profiles", fmt::format("'{}' is no free unknown of this study{}", name, suggestion(name, free)));
    if (std::count(names.begin(), names.end(), name) > 1) table.fail("profiles", fmt::format("has '{}' twice", name));
  }
  return names;
}

}  // namespace veridyn::estimation
