#include "veridyn/estimation/judgement/reasons.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::estimation {

namespace {

/// Rows that differ only in what they are about.
struct Alike {
  std::size_t first = 0;  ///< index of the row that is quoted
  std::vector<std::string> others = {};
};

bool alike(const Evidence& a, const Evidence& b) {
  return a.check == b.check && a.outcome == b.outcome && a.cause == b.cause;
}

/// Of the rows that decide, the worst first.
std::vector<Alike> worst_first(std::span<const Evidence> rows) {
  std::vector<Alike> all;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].passed() || rows[i].bears_on.empty()) continue;
    const auto same = std::ranges::find_if(all, [&](const Alike& one) { return alike(rows[one.first], rows[i]); });
    if (same == all.end())
      all.push_back({i});
    else if (const std::string& about = rows[i].about; std::ranges::count(same->others, about) == 0)
      same->others.push_back(about);
  }
  std::ranges::stable_sort(all, std::greater(), [&](const Alike& one) { return rows[one.first].outcome; });
  return all;
}

std::string text_of(const Evidence& row, std::vector<std::string> others) {
  const std::string seen = says(row);
  const bool named = row.about.empty() || mentions(seen, row.about);
  std::string text = named ? seen : fmt::format("{}: {}", row.about, seen);
  std::erase(others, row.about);
  std::erase(others, "");
  if (!others.empty()) text += fmt::format(" (likewise {})", fmt::join(others, ", "));
  return text;
}

}  // namespace

bool Reasons::quotes(std::size_t row) const {
  return std::ranges::any_of(lines, [&](const Reason& line) { return !line.is_advice && line.row == row; });
}

Reasons reasons_of(std::span<const Evidence> rows, std::size_t most) {
  Reasons reasons;
  const auto said = [&](const std::string& text) {
    return std::ranges::find(reasons.lines, text, &Reason::text) != reasons.lines.end();
  };
  for (const auto& [first, others] : worst_first(rows)) {
    const Evidence& row = rows[first];
    if (reasons.lines.size() >= most) {
      reasons.left_out += 1 + others.size();
      continue;
    }
    std::string text = text_of(row, others), advice = advice_of(row);
    if (said(text)) continue;
    reasons.lines.push_back({row.outcome, std::move(text), false, first});
    if (!advice.empty() && !said(advice) && reasons.lines.size() < most)
      reasons.lines.push_back({row.outcome, std::move(advice), true, first});
  }
  return reasons;
}

}  // namespace veridyn::estimation
