#include "veridyn/report/comparison_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/constants.hpp"
#include "veridyn/report/parts/analysis_sections.hpp"
#include "veridyn/report/parts/remarks.hpp"

namespace veridyn::report {
namespace {

using estimation::ComparedPair;
using estimation::ComparedParameter;
using estimation::NamedEstimate;
using estimation::Outcome;

Verdict agreement_verdict(const estimation::EstimateComparison& comparison) {
  Outcome worst = Outcome::kPassed;
  for (const estimation::Evidence& row : comparison.evidence) worst = std::max(worst, row.outcome);
  Verdict verdict{.level = worst == Outcome::kPassed ? Level::kGood
                           : worst == Outcome::kCare ? Level::kCaution
                                                     : Level::kBad,
                  .headline = comparison.text + "."};
  verdict.word = worst == Outcome::kPassed ? "They agree" : worst == Outcome::kCare ? "They differ" : "Contradiction";
  return verdict;
}

Status agreement_status(double p) { return p >= 0.05 ? Status::kGood : p >= 1e-3 ? Status::kCaution : Status::kBad; }

Table pair_table(const estimation::EstimateComparison& comparison, std::span<const NamedEstimate> estimates) {
  Table table{.title = "Pairs",
              .caption =
                  "Chi-square of the difference by both covariances, the estimates taken as independent: "
                  "estimates from the same rows agree better than that.",
              .columns = {{.name = "estimate"},
                          {.name = "estimate"},
                          {.name = "parameters"},
                          {.name = "chi-square"},
                          {.name = "p", .digits = 2},
                          {.name = "differs most"},
                          {.name = "standard errors", .digits = 2}}};
  for (const ComparedPair& pair : comparison.pairs)
    table.rows.push_back({.cells = {text_cell(estimates[pair.first].name), text_cell(estimates[pair.second].name),
                                    number_cell(static_cast<double>(pair.parameters), 0), number_cell(pair.chi_square),
                                    number_cell(pair.p), text_cell(pair.largest), number_cell(pair.largest_sigmas)},
                          .status = agreement_status(pair.p)});
  return table;
}

Table parameter_table(const estimation::EstimateComparison& comparison, std::span<const NamedEstimate> estimates) {
  Table table{.title = "Parameters",
              .caption =
                  "Means are weighted by the inverse variances; scatter is what lies between the estimates beyond "
                  "their own errors."};
  table.columns = {{.name = "parameter"}, {.name = "unit"}};
  for (const NamedEstimate& e : estimates) table.columns.push_back({.name = e.name});
  for (const char* name : {"mean", "sigma", "scatter", "p"}) table.columns.push_back({.name = name, .digits = 3});
  for (const ComparedParameter& p : comparison.parameters) {
    Row row{.cells = {text_cell(p.name), text_cell(p.unit == "1" ? "" : p.unit)}, .status = agreement_status(p.p)};
    for (const estimation::Parameter* by : p.by) row.cells.push_back(number_cell(by != nullptr ? by->value : kNaN));
    for (const double v : {p.mean, p.sigma, p.between_sigma, p.p}) row.cells.push_back(number_cell(v));
    table.rows.push_back(std::move(row));
  }
  return table;
}

IntervalPlot interval_plot(const estimation::EstimateComparison& comparison, std::span<const NamedEstimate> estimates) {
  IntervalPlot plot{.title = "Intervals of 95 %", .reference_name = "mean"};
  for (const NamedEstimate& e : estimates) plot.methods.push_back(e.name);
  for (const ComparedParameter& p : comparison.parameters) {
    IntervalRow row{.name = p.name, .unit = p.unit == "1" ? "" : p.unit, .reference = p.mean};
    for (const estimation::Parameter* by : p.by)
      row.estimates.push_back(by != nullptr ? Interval{by->value, by->low95, by->high95} : Interval{kNaN, kNaN, kNaN});
    plot.rows.push_back(std::move(row));
  }
  return plot;
}

}  // namespace

Document comparison_report(const estimation::EstimateComparison& comparison, std::span<const NamedEstimate> estimates,
                           const std::string& program) {
  Document document = started_document("Estimates compared", "Do they agree within their error bars?", program);
  document.verdict = agreement_verdict(comparison);
  for (const NamedEstimate& e : estimates)
    document.facts.push_back({.name = e.name, .value = fmt::format("{}, {}", e.estimate.subject, e.estimate.method)});
  Section section{.title = "Side by side", .id = "comparison"};
  section.blocks = {pair_table(comparison, estimates), interval_plot(comparison, estimates),
                    parameter_table(comparison, estimates)};
  document.sections.push_back(std::move(section));
  estimation::Estimate rows;
  rows.evidence = comparison.evidence;
  document.sections.push_back(evidence_section(rows));
  add_notes(document, comparison.notes);
  return document;
}

}  // namespace veridyn::report
