#include "veridyn/estimation/judgement/reasons.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::estimation {

Reasons reasons_of(std::span<const Evidence> rows, std::size_t most) {
  std::vector<const Evidence*> worst_first;
  for (const Evidence& row : rows)
    if (!row.passed() && !row.bears_on.empty()) worst_first.push_back(&row);
  std::ranges::stable_sort(worst_first, std::greater(), [](const Evidence* row) { return row->outcome; });
  Reasons reasons;
  const auto said = [&](const std::string& text) {
    return std::ranges::find(reasons.lines, text, &Reason::text) != reasons.lines.end();
  };
  for (const Evidence* row : worst_first) {
    if (reasons.lines.size() >= most) {
      ++reasons.left_out;
      continue;
    }
    const std::string seen = says(*row), advice = advice_of(*row);
    const bool named = row->about.empty() || seen.find(row->about) != std::string::npos;
    std::string text = named ? seen : fmt::format("{}: {}", row->about, seen);
    if (said(text)) continue;
    reasons.lines.push_back({row->outcome, std::move(text)});
    if (!advice.empty() && !said(advice) && reasons.lines.size() < most)
      reasons.lines.push_back({row->outcome, advice, true});
  }
  return reasons;
}

}  // namespace veridyn::estimation
