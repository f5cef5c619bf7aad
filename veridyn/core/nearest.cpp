#include "veridyn/core/nearest.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

namespace veridyn {
namespace {

bool same_letter(char a, char b) {
  return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> above(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = above[j - 1] + (same_letter(a[i - 1], b[j - 1]) ? 0 : 1);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && same_letter(a[i - 1], b[j - 2]) && same_letter(a[i - 2], b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, above);
    std::swap(above, row);
  }
  return above[b.size()];
}

std::string nearest(std::string_view word, std::span<const std::string> candidates) {
  const std::string* best = nullptr;
  std::size_t best_distance = 0;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (best == nullptr || distance < best_distance) {
      best = &candidate;
      best_distance = distance;
    }
  }
  if (best == nullptr) return {};
  const std::size_t letters = std::max(word.size(), best->size());
  return best_distance <= std::max<std::size_t>(1, letters / 3) ? *best : std::string{};
}

std::string suggestion(std::string_view word, std::span<const std::string> candidates, std::size_t limit) {
  if (candidates.empty()) return " (there are none)";
  if (const std::string close = nearest(word, candidates); !close.empty()) {
    return fmt::format(" (did you mean '{}'?)", close);
  }
  const std::size_t shown = std::min(limit, candidates.size());
  const std::string more = shown < candidates.size() ? fmt::format(", and {} more", candidates.size() - shown) : "";
  return fmt::format(" (known: {}{})",
                     fmt::join(candidates.begin(), candidates.begin() + static_cast<long>(shown), ", "), more);
}

}  // namespace veridyn
