#include "veridyn/report/parts/analysis_sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/judgement/check_table.hpp"
#include "veridyn/estimation/judgement/reasons.hpp"
#include "veridyn/report/document/number_format.hpp"
#include "veridyn/report/parts/estimate_tables.hpp"

namespace veridyn::report {
namespace {

using estimation::Analysis;
using estimation::GroupVerdict;
using estimation::MethodResult;
using estimation::Parameter;
using estimation::ParameterGroup;

bool has_values(const ParameterGroup& group) {
  return !group.parameters.empty() && (estimation::usable(group.verdict) || group.verdict == GroupVerdict::kNotExcited);
}

/// "noise 62 %, delays 31 %": shares of the variance, the largest first, of what has at least a twentieth.
std::string shares_of(std::span<const estimation::IntervalPart> parts) {
  constexpr double kSmallest = 0.05;
  std::vector<estimation::IntervalPart> sorted(parts.begin(), parts.end());
  std::ranges::sort(sorted, std::ranges::greater(), &estimation::IntervalPart::sigma);
  double variance = 0.0;
  for (const estimation::IntervalPart& part : sorted) variance += part.sigma * part.sigma;
  std::string words;
  for (const estimation::IntervalPart& part : sorted) {
    const double share = part.sigma * part.sigma / variance;
    if (share >= kSmallest)
      words += fmt::format("{}{} {:.0f}\u00a0%", words.empty() ? "" : ", ", part.words, 100.0 * share);
  }
  return words;
}

/// A level, which is counted.
bool is_whole(double value) { return value == std::round(value); }

/// Parameters that at least two methods estimated; one method alone compares with nothing.
std::vector<std::string> compared(const ParameterGroup& group) {
  std::vector<std::string> names;
  for (const MethodResult& method : group.methods) {
    for (const Parameter& p : method.parameters) {
      const auto has = [&](const MethodResult& m) { return m.usable && m.find(p.name) != nullptr; };
      if (std::ranges::count_if(group.methods, has) < 2 || std::ranges::count(names, p.name) > 0) continue;
      names.push_back(p.name);
    }
  }
  return names;
}

IntervalPlot interval_plot(const Analysis& analysis, const ParameterGroup& group) {
  IntervalPlot plot{
      .title = fmt::format("{}: estimates of all methods", group.name),
      .caption = "Bars are 95 % intervals. Methods that disagree by more than their bars contradict each other.",
      .reference_name = "truth"};
  for (const MethodResult& method : group.methods)
    if (method.usable) plot.methods.push_back(method.method);
  for (const std::string& name : compared(group)) {
    IntervalRow row{.name = name};
    double factor = 1.0;
    for (const MethodResult& method : group.methods) {
      if (!method.usable) continue;
      const Parameter* p = method.find(name);
      if (p == nullptr) {
        row.estimates.push_back({kNaN, kNaN, kNaN});
        continue;
      }
      const ReadableNumber unit = readable(1.0, p->unit, p->name);
      factor = unit.value;
      row.unit = unit.unit;
      row.estimates.push_back({p->value * factor, p->low95 * factor, p->high95 * factor, status_of(p->status)});
    }
    const double truth = analysis.true_value(name);
    if (std::isfinite(truth)) row.reference = truth * factor;
    plot.rows.push_back(std::move(row));
  }
  return plot;
}

void add_comparison(Section& section, const Analysis& analysis, const ParameterGroup& group) {
  IntervalPlot plot = interval_plot(analysis, group);
  if (!plot.rows.empty()) section.blocks.emplace_back(std::move(plot));
  for (const MethodResult& method : group.methods) {
    if (!method.usable)
      section.blocks.emplace_back(
          Paragraph{fmt::format("{}, {}: {}", group.name, method.method, method.message), Tone::kNote});
  }
}

}  // namespace

Status status_of(GroupVerdict verdict) {
  switch (verdict) {
    case GroupVerdict::kIdentified:
      return Status::kIdentified;
    case GroupVerdict::kEffective:
      return Status::kCaution;
    case GroupVerdict::kNotExcited:
      return Status::kNotExcited;
    case GroupVerdict::kRejected:
      return Status::kRejected;
    case GroupVerdict::kSkipped:
      return Status::kNone;
  }
  return Status::kNone;
}

Section parameters_section(const Analysis& analysis, std::string caption) {
  Section section{.title = "Parameters", .id = "parameters"};
  Table table{.title = "Parameters",
              .caption =
                  "95 % intervals allow for autocorrelated residuals and, of flights and drives, for what is left open "
                  "of sensors. A parameter "
                  "whose interval includes zero is marked insignificant, not set to zero. " +
                  std::move(caption),
              .columns = parameter_columns(!analysis.truth.empty())};
  const auto& parts = analysis.estimate.interval_parts;
  if (!parts.empty()) table.columns.push_back({.name = "interval by", .align = Align::kLeft});
  for (const ParameterGroup& group : analysis.groups) {
    if (!has_values(group)) continue;
    for (const Parameter& p : group.parameters) {
      const ReadableNumber unit = readable(1.0, p.unit, p.name);
      Row row = parameter_row(p, unit.value, unit.unit);
      if (!analysis.truth.empty())
        row.cells.push_back(measured_cell(analysis.true_value(p.name) * unit.value, p.sigma * unit.value));
      if (const auto found = parts.find(p.name); found != parts.end()) {
        row.cells.push_back(text_cell(shares_of(found->second)));
      } else if (!parts.empty()) {
        row.cells.push_back(text_cell(""));
      }
      table.rows.push_back(std::move(row));
    }
  }
  if (table.rows.empty()) {
    section.blocks.emplace_back(Paragraph{"Nothing was identified, so there is no table of parameters.", Tone::kNote});
  } else {
    section.blocks.emplace_back(std::move(table));
  }
  return section;
}

Section derived_section(const estimation::Estimate& estimate, std::string title, std::string caption) {
  Section section{.title = title, .id = "derived"};
  if (estimate.derived.empty()) return section;
  Table table{.title = std::move(title),
              .caption = std::move(caption),
              .columns = {{.name = "of", .align = Align::kLeft},
                          {.name = "quantity", .align = Align::kLeft},
                          {.name = "value", .digits = 3},
                          {.name = "from", .digits = 3, .group = "95 % interval"},
                          {.name = "to", .digits = 3, .group = "95 % interval"},
                          {.name = "unit", .align = Align::kLeft},
                          {.name = "note", .align = Align::kLeft}}};
  for (const estimation::DerivedQuantity& quantity : estimate.derived) {
    std::string name = quantity.name.substr(quantity.name.find('.') + 1);
    std::ranges::replace(name, '_', ' ');
    const bool whole = is_whole(quantity.value) && is_whole(quantity.low95) && is_whole(quantity.high95);
    const auto cell = [&](double value) { return whole ? number_cell(value, 0) : number_cell(value); };
    table.rows.push_back({.cells = {text_cell(quantity.group), text_cell(std::move(name)), cell(quantity.value),
                                    cell(quantity.low95), cell(quantity.high95),
                                    text_cell(quantity.unit == "1" ? "" : quantity.unit), text_cell(quantity.note)}});
  }
  section.blocks.emplace_back(std::move(table));
  return section;
}

Section methods_section(const Analysis& analysis) {
  Section section{.title = "Estimates of all methods", .id = "methods", .folded = true};
  for (const ParameterGroup& group : analysis.groups) {
    if (group.verdict != GroupVerdict::kRejected) add_comparison(section, analysis, group);
  }
  return section;
}

Section rejected_section(const Analysis& analysis) {
  Section section{.title = "Rejected estimates (do not use)", .id = "rejected", .folded = true};
  for (const ParameterGroup& group : analysis.groups) {
    if (group.verdict != GroupVerdict::kRejected || group.methods.empty()) continue;
    add_comparison(section, analysis, group);
  }
  if (!section.blocks.empty()) {
    section.blocks.insert(section.blocks.begin(),
                          Paragraph{"To see what went wrong. These numbers must not be used.", Tone::kWarning});
  }
  return section;
}

Verdict verdict_of(const estimation::Estimate& estimate) {
  using estimation::Grade;
  const estimation::Judgement& j = estimate.judgement;
  Verdict verdict{.headline = estimation::sentence_of(estimate)};
  const auto no = [](const estimation::PurposeGrade& g) {
    return g.grade == Grade::kNo || g.grade == Grade::kNotJudged;
  };
  const bool all =
      std::ranges::all_of(estimation::kPurposes, [&](estimation::Purpose p) { return j.of(p).grade == Grade::kYes; });
  verdict.level = all ? Level::kGood : no(j.parameters) && no(j.prediction) ? Level::kBad : Level::kCaution;
  const estimation::Reasons reasons = estimation::reasons_of(estimate.evidence);
  for (const estimation::Reason& reason : reasons.lines)
    verdict.lines.push_back(reason.is_advice ? "What to do: " + reason.text : reason.text);
  if (reasons.left_out > 0)
    verdict.lines.push_back(fmt::format("and {} more, in \"What was checked\"", reasons.left_out));
  return verdict;
}

Section evidence_section(const estimation::Estimate& estimate) {
  using estimation::Outcome;
  Section section{.title = "What was checked", .id = "evidence", .folded = true};
  const std::vector<estimation::Evidence>& rows = estimate.evidence;
  const estimation::Reasons reasons = estimation::reasons_of(rows);
  // Nothing: what did not pass and decides nothing.
  const auto kind_of = [](const estimation::Evidence& row) {
    return row.bears_on.empty() && !row.passed() ? std::nullopt : std::optional(row.outcome);
  };
  for (const std::optional<Outcome> kind :
       {std::optional(Outcome::kFailed), std::optional(Outcome::kMissing), std::optional(Outcome::kCare),
        std::optional(Outcome::kNotVerified), std::optional<Outcome>(), std::optional(Outcome::kPassed)}) {
    Table table{.columns = evidence_columns()};
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (kind_of(rows[i]) == kind) table.rows.push_back(evidence_row(rows[i], reasons.quotes(i)));
    if (table.rows.empty()) continue;
    const std::string_view word = kind ? estimation::to_string(*kind) : "for information";
    section.inside += fmt::format("{}{} {}", section.inside.empty() ? "" : ", ", table.rows.size(), word);
    table.title = fmt::format("{} of {} {}", table.rows.size(), rows.size(), word);
    section.blocks.emplace_back(std::move(table));
  }
  if (!section.blocks.empty())
    section.blocks.insert(section.blocks.begin(), Paragraph{"The grades follow from these rows alone: each bears on "
                                                            "the data, the parameters or the prediction."});
  return section;
}

Table prediction_table(std::span<const estimation::PredictedQuantity> predictions, std::string title) {
  Table table{
      .title = std::move(title),
      .caption =
          "MAE: mean absolute error, RMSE: root mean square error, R2: share of the variance explained, Theil: "
          "inequality coefficient (0 perfect), lag 1: autocorrelation of the residual at one sample (0 when the "
          "model explains all but white noise).",
      .columns = {{.name = "quantity", .align = Align::kLeft},
                  {.name = "MAE", .digits = 3},
                  {.name = "RMSE", .digits = 3},
                  {.name = "unit", .align = Align::kLeft},
                  {.name = "R2", .digits = 3},
                  {.name = "Theil", .digits = 3},
                  {.name = "lag 1", .digits = 2},
                  {.name = "samples"}}};
  for (const estimation::PredictedQuantity& q : predictions) {
    const ReadableNumber unit = readable(1.0, q.unit);
    table.rows.push_back(
        {.cells = {text_cell(q.name), number_cell(q.fit.mae * unit.value), number_cell(q.fit.rmse * unit.value),
                   text_cell(unit.unit), number_cell(q.fit.r2), number_cell(q.fit.theil), number_cell(q.lag1),
                   number_cell(static_cast<double>(q.fit.count), 0)}});
  }
  return table;
}

}  // namespace veridyn::report
