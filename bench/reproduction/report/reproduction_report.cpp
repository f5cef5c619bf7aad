#include "bench/reproduction/report/reproduction_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/index.hpp"
#include "veridyn/report/parts/remarks.hpp"

namespace veridyn::report {
namespace {

Section section_of(const ReproducedRow& row) {
  // What failed is open.
  Section section{.title = row.title, .folded = row.passed()};
  if (!row.finding.empty()) section.blocks.push_back(Paragraph{.text = "Published: " + row.finding});
  section.blocks.push_back(Paragraph{.text = "Ours: " + row.ours, .tone = Tone::kNote});
  Table checks{.title = "What must be seen",
               .columns = {{.name = ""}, {.name = "seen", .align = Align::kLeft}},
               .sortable = false};
  for (const CheckOutcome& check : row.checks) {
    const Status status = check.passed ? Status::kGood : Status::kBad;
    checks.rows.push_back({.cells = {status_cell(status), text_cell(check.text)}, .status = status});
  }
  section.blocks.push_back(std::move(checks));
  section.blocks.insert(section.blocks.end(), row.blocks.begin(), row.blocks.end());
  return section;
}

}  // namespace

bool ReproducedRow::passed() const {
  return std::all_of(checks.begin(), checks.end(), [](const CheckOutcome& check) { return check.passed; });
}

Document reproduction_report(const std::string& domain, std::span<const ReproducedRow> rows,
                             const std::string& program) {
  Document document = started_document("Published results, reproduced", domain, program);
  const auto passed = std::count_if(rows.begin(), rows.end(), [](const ReproducedRow& r) { return r.passed(); });
  const auto all = signed_index(rows.size());
  document.verdict.level = passed == all ? Level::kGood : Level::kBad;
  document.verdict.word = passed == all ? "Reproduced" : "Not all reproduced";
  document.verdict.headline = fmt::format("{} of {} published results show what they must.", passed, all);
  Table summary{
      .title = "All rows",
      .columns = {{.name = ""}, {.name = "case", .align = Align::kLeft}, {.name = "seen", .align = Align::kLeft}},
      .sortable = false};
  for (const ReproducedRow& r : rows) {
    const Status status = r.passed() ? Status::kGood : Status::kBad;
    // Many checks: their number, and those that failed.
    constexpr std::size_t kMostTexts = 6;
    const bool many = r.checks.size() > kMostTexts;
    const auto good = std::count_if(r.checks.begin(), r.checks.end(), [](const CheckOutcome& c) { return c.passed; });
    std::string seen = many ? fmt::format("{} of {} checks passed", good, r.checks.size()) : "";
    for (const CheckOutcome& check : r.checks) {
      if (!many || !check.passed) seen += (seen.empty() ? "" : "; ") + check.text;
    }
    summary.rows.push_back({.cells = {status_cell(status), text_cell(r.title), text_cell(seen)}, .status = status});
  }
  document.sections.push_back({.title = "Summary", .blocks = {summary}});
  for (const ReproducedRow& r : rows) document.sections.push_back(section_of(r));
  return document;
}

}  // namespace veridyn::report
