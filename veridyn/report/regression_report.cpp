#include "veridyn/report/regression_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/report/parts/analysis_sections.hpp"
#include "veridyn/report/parts/remarks.hpp"

namespace veridyn::report {
namespace {

std::vector<double> entries_of(const Eigen::VectorXd& v) { return {v.data(), v.data() + v.size()}; }

Section fit_section(const estimation::JudgedRegression& result) {
  Section section{.title = "Measured and modelled", .id = "fit"};
  if (!result.chosen) return section;
  const std::vector<double> measured = entries_of(result.data.regressand), modelled = entries_of(result.predicted);
  const auto [low, high] = std::ranges::minmax(measured);
  section.blocks.emplace_back(XYPlot{.title = "Fit",
                                     .x = {.label = result.data.regressand_name},
                                     .y = {.label = "modelled"},
                                     .series = {{.name = "rows", .x = measured, .y = modelled},
                                                {.name = "modelled = measured",
                                                 .x = {low, high},
                                                 .y = {low, high},
                                                 .role = Role::kReference,
                                                 .style = Style::kLine}}});
  std::vector<double> row, residual;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    row.push_back(static_cast<double>(i + 1));
    residual.push_back(measured[i] - modelled[i]);
  }
  section.blocks.emplace_back(XYPlot{.title = "Residual by row",
                                     .x = {.label = "row"},
                                     .y = {.label = "measured less modelled"},
                                     .series = {{.name = "residual", .x = row, .y = residual}}});
  return section;
}

Section terms_section(const estimation::JudgedRegression& result) {
  Section section{.title = "Choice of terms", .id = "structure"};
  if (!result.search) return section;
  Table table{.caption = result.search->text,
              .columns = {{.name = "step"},
                          {.name = "term"},
                          {.name = "terms"},
                          {.name = "partial F"},
                          {.name = "R2"},
                          {.name = "why"}}};
  for (const estimation::StructureStep& step : result.search->history)
    table.rows.push_back({.cells = {text_cell(std::string(to_string(step.action))), text_cell(step.term),
                                    number_cell(static_cast<double>(step.terms), 0), number_cell(step.F),
                                    number_cell(step.r2), text_cell(step.reason)}});
  section.blocks.emplace_back(std::move(table));
  return section;
}

}  // namespace

Document regression_report(const estimation::JudgedRegression& result, const std::string& source,
                           const std::string& program) {
  Document document =
      started_document(fmt::format("{}: regression", result.data.regressand_name), "Of a plain table", program);
  document.verdict = verdict_of(result.estimate);
  document.facts = {{.name = "Table", .value = source},
                    {.name = "Rows", .value = fmt::format("{} ({} left out)", result.data.rows(), result.dropped)},
                    {.name = "Method", .value = result.estimate.method.empty() ? "none" : result.estimate.method}};
  for (Section section :
       {parameters_section(result, "Intervals of 95 %, for the residual's autocorrelation."), methods_section(result),
        terms_section(result), fit_section(result), evidence_section(result.estimate), rejected_section(result)})
    if (!section.blocks.empty()) document.sections.push_back(std::move(section));
  add_warnings(document, result.estimate.warnings);
  return document;
}

}  // namespace veridyn::report
