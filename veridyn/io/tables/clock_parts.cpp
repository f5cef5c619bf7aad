#include "veridyn/io/tables/clock_parts.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/error.hpp"

namespace veridyn::io::internal {

std::vector<ClockPart> clock_parts(std::span<const std::size_t> restarts, std::size_t rows) {
  std::vector<ClockPart> parts;
  std::size_t begin = 0;
  for (std::size_t i = 0; i <= restarts.size(); ++i) {
    const std::size_t end = i < restarts.size() ? restarts[i] : rows;
    if (end - begin < kShortestPart) return {};
    parts.push_back({begin, end});
    begin = end;
  }
  return parts;
}

std::size_t choose_part(std::span<const ClockPart> parts, std::span<const double> stamps, std::size_t chosen,
                        const std::string& source) {
  if (chosen > parts.size()) {
    throw InputError(source, fmt::format("has no part {}: its clock restarts {} times, which makes {} part{}", chosen,
                                         parts.size() - 1, parts.size(), parts.size() == 1 ? "" : "s"));
  }
  if (chosen > 0) return chosen - 1;
  const auto duration = [&](const ClockPart& part) { return stamps[part.end - 1] - stamps[part.begin]; };
  const auto longest = std::max_element(
      parts.begin(), parts.end(), [&](const ClockPart& a, const ClockPart& b) { return duration(a) < duration(b); });
  return static_cast<std::size_t>(longest - parts.begin());
}

std::string parts_in_words(std::span<const ClockPart> parts, std::span<const double> stamps, std::size_t read) {
  constexpr std::size_t kListed = 12;
  std::string text = "the clock restarts: ";
  for (std::size_t i = 0; i < std::min(parts.size(), kListed); ++i) {
    text += fmt::format("{}part {} (rows {} to {}, {:.9g} s to {:.9g} s)", i == 0 ? "" : ", ", i + 1,
                        parts[i].begin + 1, parts[i].end, stamps[parts[i].begin], stamps[parts[i].end - 1]);
  }
  if (parts.size() > kListed) text += fmt::format(" and {} more", parts.size() - kListed);
  const std::size_t other = read == 0 ? 2 : 1;
  return text + fmt::format("; part {} is read, `part = {}` in [data] takes another", read + 1, other);
}

}  // namespace veridyn::io::internal
