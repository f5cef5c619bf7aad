#include "veridyn/core/study_placeholders.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "veridyn/core/text.hpp"

namespace veridyn::internal {

std::string placeholder_refusal(std::string_view text, std::uint32_t line, std::vector<Placeholder> all) {
  std::erase_if(all, [&](const Placeholder& one) { return one.line == line; });
  std::ranges::stable_sort(all, {}, &Placeholder::line);
  std::vector<std::string> others;
  for (const Placeholder& one : all) others.push_back(fmt::format("{} (line {})", one.name, one.line));
  if (!others.empty()) {
    return fmt::format("is still the template's placeholder, as {} {}: put in your own values",
                       others.size() == 1 ? "is" : "are", fmt::join(others, ", "));
  }
  const std::string_view unit = trimmed(text.substr(1));
  return fmt::format("is still the template's placeholder: put in your own {}",
                     unit.empty() ? "value" : fmt::format("number [{}]", unit));
}

}  // namespace veridyn::internal
