#include "veridyn/report/response_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/report/parts/index_blocks.hpp"
#include "veridyn/report/parts/remarks.hpp"

namespace veridyn::report {
namespace {

using estimation::IndexInput;
using estimation::ResponseIndices;
using estimation::ResultIndices;

/// A total order from which an input counts as one that moves a result.
constexpr double kMoves = 0.05;

std::string unit_shown(const std::string& unit) { return unit == "1" ? std::string() : unit; }

/// Weight of an input in a result: total order, or mu* over the largest of the result.
double weight(const ResultIndices& r, std::size_t input) {
  if (input < r.variance.inputs.size()) return r.variance.inputs[input].total;
  double most = 0.0;
  for (const numerics::MorrisEffect& e : r.morris) most = std::max(most, e.absolute);
  return input < r.morris.size() && most > 0.0 ? r.morris[input].absolute / most : kNaN;
}

/// Greatest weight of an input in any result, and which.
std::pair<double, std::size_t> greatest(const ResponseIndices& s, std::size_t input) {
  std::pair<double, std::size_t> best{0.0, 0};
  for (std::size_t k = 0; k < s.results.size(); ++k) {
    const double w = weight(s.results[k], input);
    if (w > best.first) best = {w, k};
  }
  return best;
}

std::string names_where(const ResponseIndices& s, bool moving) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < s.inputs.size(); ++i)
    if ((greatest(s, i).first >= kMoves) == moving) names.push_back(s.inputs[i].name);
  return fmt::format("{}", fmt::join(names, ", "));
}

Verdict response_verdict(const ResponseIndices& s, bool variance) {
  Verdict v{.level = s.failed == 0 ? Level::kGood : Level::kCaution};
  v.word = s.failed == 0 ? "Every run finished" : "With care";
  const char* share = variance ? "5 % of the variance" : "5 % of the largest effect";
  const std::string moving = names_where(s, true), idle = names_where(s, false);
  v.headline = moving.empty() ? fmt::format("No input has {} of any result.", share)
                              : fmt::format("At least {} of some result is due to {}.", share, moving);
  if (!idle.empty())
    v.lines.push_back(
        fmt::format("Less of every result is due to {}: within its range it need not be known better, and this motion "
                    "tells little about it.",
                    idle));
  if (s.failed > 0) v.lines.push_back(fmt::format("{} of {} runs could not finish.", s.failed, s.runs));
  v.lines.emplace_back(
      "Shares depend on the ranges: an input that is known twice as well has a quarter of the variance. They say what "
      "moves a result, not whether inputs can be distinguished from each other.");
  return v;
}

Matrix response_map(const ResponseIndices& s, bool variance) {
  Matrix map{.title = variance ? "Total order [%]" : "Effect over the largest of the result [%]",
             .caption = variance ? "Share of a result's variance (columns) that is left when only this input (rows) is "
                                   "not known. Columns add up to more than 100 % where inputs interact."
                                 : "mu* of Morris over the largest of the column.",
             .row_names = s.input_names(),
             .low = 0.0,
             .high = 100.0,
             .decimals = 0};
  for (const estimation::Response& r : s.responses) map.column_names.push_back(r.name);
  for (std::size_t i = 0; i < s.inputs.size(); ++i) {
    std::vector<double> row;
    for (const ResultIndices& r : s.results) row.push_back(100.0 * weight(r, i));
    map.values.push_back(std::move(row));
  }
  return map;
}

Table result_table(const ResponseIndices& s) {
  Table table{.title = "Results",
              .caption =
                  "Nominal, and over all points of the design. Sum of first orders: near 1 where the result is "
                  "nearly linear in the inputs; what is missing is interaction.",
              .columns = {{.name = "result", .align = Align::kLeft},
                          {.name = "nominal"},
                          {.name = "mean"},
                          {.name = "standard deviation"},
                          {.name = "unit", .align = Align::kLeft},
                          {.name = "sum of first orders", .digits = 3},
                          {.name = "moved most by", .align = Align::kLeft},
                          {.name = "runs without it"}}};
  for (std::size_t k = 0; k < s.results.size(); ++k) {
    const numerics::SensitivityIndices& v = s.results[k].variance;
    const bool known = !v.inputs.empty();
    double first = 0.0;
    for (const numerics::SensitivityIndex& x : v.inputs) first += x.first;
    const std::optional<std::size_t> most = s.strongest(k);
    table.rows.push_back(
        {.cells = {text_cell(s.responses[k].name), number_cell(s.responses[k].nominal),
                   number_cell(known ? v.mean : kNaN), number_cell(known ? std::sqrt(v.variance) : kNaN),
                   text_cell(unit_shown(s.responses[k].unit)), number_cell(known ? first : kNaN),
                   text_cell(most ? s.inputs[*most].name : ""),
                   number_cell(static_cast<double>(s.results[k].failed), 0)}});
  }
  return table;
}

Table input_table(const ResponseIndices& s) {
  Table table{.title = "Inputs",
              .columns = {{.name = "input", .align = Align::kLeft},
                          {.name = "nominal"},
                          {.name = "from"},
                          {.name = "to"},
                          {.name = "unit", .align = Align::kLeft},
                          {.name = "moves most", .align = Align::kLeft},
                          {.name = "share of it", .unit = "%", .digits = 3}}};
  for (std::size_t i = 0; i < s.inputs.size(); ++i) {
    const IndexInput& input = s.inputs[i];
    const auto [share, result] = greatest(s, i);
    table.rows.push_back(
        {.cells = {text_cell(input.name), number_cell(input.nominal), number_cell(input.low), number_cell(input.high),
                   text_cell(unit_shown(input.unit)), text_cell(share > 0.0 ? s.responses[result].name : ""),
                   number_cell(100.0 * share)}});
  }
  return table;
}

/// A badge where the interval is wide.
Cell order_cell(double value, double low, double high) {
  const std::string text = fmt::format("{:.3f} ({:.3f} to {:.3f})", value, low, high);
  return estimation::wide_interval(value, low, high) && value >= kMoves ? status_cell(Status::kCaution, text)
                                                                        : text_cell(text);
}

Table order_table(const ResponseIndices& s, std::size_t k, double level) {
  Table table{
      .title = s.responses[k].name + ": indices",
      .caption = fmt::format("With {:g} % intervals. Marked: an input that moves the result by 5 % or more, with "
                             "an interval wider than {:g} % of the index.",
                             100.0 * level, 100.0 * estimation::kWideInterval),
      .columns = {{.name = "input", .align = Align::kLeft}, {.name = "first order"}, {.name = "total order"}}};
  const numerics::SensitivityIndices& v = s.results[k].variance;
  for (std::size_t i = 0; i < v.inputs.size(); ++i) {
    const numerics::SensitivityIndex& x = v.inputs[i];
    table.rows.push_back({.cells = {text_cell(s.inputs[i].name), order_cell(x.first, x.first_low, x.first_high),
                                    order_cell(x.total, x.total_low, x.total_high)}});
  }
  return table;
}

Section detail_section(const ResponseIndices& s, const estimation::IndexOptions& options) {
  const bool variance = options.method == estimation::IndexMethod::kVariance;
  Section section{.title = variance ? "First and total order" : "Elementary effects", .id = "indices"};
  section.blocks.emplace_back(index_explanation(variance));
  const std::vector<std::string> inputs = s.input_names();
  for (std::size_t k = 0; k < s.results.size(); ++k) {
    const IndexedResult result{
        .indices = s.results[k], .inputs = inputs, .quantity = "the result", .unit = unit_shown(s.responses[k].unit)};
    if (!s.results[k].variance.inputs.empty()) {
      section.blocks.emplace_back(index_plot(result, options.variance.level));
      section.blocks.emplace_back(order_table(s, k, options.variance.level));
    }
    if (!s.results[k].morris.empty()) section.blocks.emplace_back(morris_table(result));
  }
  return section;
}

}  // namespace

Document response_report(const ResponseIndices& indices, const estimation::IndexOptions& options,
                         const ResponseReportContext& context) {
  const bool variance = options.method == estimation::IndexMethod::kVariance;
  Document document = started_document(context.title, context.subject, context.program);
  document.verdict = response_verdict(indices, variance);
  document.facts = context.facts;
  document.facts.push_back({"Inputs", fmt::format("{}", indices.inputs.size())});
  document.facts.push_back({"Runs", fmt::format("{}, {} failed", indices.runs, indices.failed)});
  document.facts.push_back({"Seed", fmt::format("{}", options.variance.seed)});
  Section map{.title = "Which input moves which result", .id = "map"};
  map.blocks.emplace_back(Paragraph{context.what});
  if (!indices.results.empty()) map.blocks.emplace_back(response_map(indices, variance));
  if (!indices.constant.empty())
    map.blocks.emplace_back(
        Paragraph{fmt::format("No input moves {}.", fmt::join(indices.constant, ", ")), Tone::kNote});
  document.sections.push_back(std::move(map));
  Section ranges{.title = "Inputs and results", .id = "ranges"};
  ranges.blocks.emplace_back(input_table(indices));
  if (!indices.results.empty()) ranges.blocks.emplace_back(result_table(indices));
  document.sections.push_back(std::move(ranges));
  if (!indices.results.empty()) document.sections.push_back(detail_section(indices, options));
  add_warnings(document, indices.warnings);
  std::vector<std::string> notes = context.notes;
  notes.push_back(fmt::format("{} runs in {:.1f} s, {:.1f} s of processor time.", indices.runs, indices.seconds,
                              indices.processor_seconds));
  add_notes(document, notes);
  return document;
}

}  // namespace veridyn::report
