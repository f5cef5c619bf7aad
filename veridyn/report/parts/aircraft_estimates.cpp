#include "veridyn/report/parts/aircraft_estimates.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <span>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/report/figures/curves.hpp"
#include "veridyn/report/parts/analysis_sections.hpp"
#include "veridyn/report/parts/estimate_tables.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::aircraft;
using estimation::RegressionEstimate;

std::vector<Column> estimate_columns(std::vector<Column> names, Column last) {
  for (const char* name : {"Value", "Sigma"}) names.push_back({.name = name});
  for (const char* name : {"95 % low", "95 % high"}) names.push_back({.name = name, .group = "interval"});
  names.push_back({.name = "Unit"});
  names.push_back(std::move(last));
  return names;
}

/// A row of these columns: what names an estimate, its numbers with the interval, and one more number.
Row estimate_row(std::vector<Cell> names, const estimation::Parameter& e, Cell last) {
  Row row{.cells = std::move(names)};
  for (Cell& cell : interval_cells(e.value, e.sigma, e.low95, e.high95)) row.cells.push_back(std::move(cell));
  row.cells.push_back(text_cell(e.unit));
  row.cells.push_back(std::move(last));
  return row;
}

Table comparison_table(const FlightAnalysis& analysis) {
  Table table{.title = "Comparison",
              .columns = estimate_columns({{.name = "Parameter"}, {.name = "Method"}, {.name = "Status"}},
                                          {.name = "Apart", .unit = "sigma", .digits = 2})};
  for (const CoefficientResult& r : analysis.coefficients) {
    if (!r.chosen) continue;
    for (const auto& p : r.chosen->parameters) {
      table.rows.push_back(estimate_row({text_cell(p.name), text_cell(r.method), status_cell(status_of(p.status))}, p,
                                        number_cell(kNaN)));
      for (const OtherParameter& other : analysis.others.parameters) {
        const auto& [method, e] = other.estimate;
        if (e.name != p.name) continue;
        const bool contradicts = std::abs(other.normalised_difference) > 3.0;
        table.rows.push_back(estimate_row({text_cell(""), text_cell(method), status_cell(status_of(e.status))}, e,
                                          number_cell(other.normalised_difference)));
        if (contradicts) table.rows.back().status = Status::kCaution;
      }
    }
  }
  return table;
}

Table output_table(const AxisOutputError& run) {
  Table outputs{.title = fmt::format("Output error, {}: outputs", to_string(run.axis)),
                .caption =
                    "Noise: estimated standard deviation of the residual. Lag 1: its autocorrelation at one "
                    "sample, 0 when white; the error bars are corrected for it.",
                .columns = {{.name = "Output"},
                            {.name = "Noise", .digits = 3},
                            {.name = "Unit"},
                            {.name = "R2", .digits = 3},
                            {.name = "Theil", .digits = 3},
                            {.name = "Lag 1", .digits = 3}}};
  for (const estimation::OutputFit& o : run.estimate.outputs) {
    outputs.rows.push_back({.cells = {text_cell(o.name), number_cell(o.noise_sd), text_cell(o.unit),
                                      number_cell(o.fit.r2), number_cell(o.fit.theil), number_cell(o.lag1)}});
  }
  return outputs;
}

}  // namespace

bool identified(const CoefficientResult& r) { return r.chosen && r.verdict == estimation::GroupVerdict::kIdentified; }

Section coefficients_section(const FlightAnalysis& analysis) {
  Section section{.title = "Coefficients", .id = "coefficients"};
  Table table{
      .title = "Verdict per coefficient",
      .caption =
          "Explained: share of the coefficient's variance on the hold-out that the model accounts for (R squared). "
          "Theil: inequality coefficient, 0 perfect, below 0.3 good. Equation error: residual variance over what "
          "sensor "
          "noise alone would leave; 1 when the model is complete.",
      .columns = {{.name = "Coefficient"},
                  {.name = "Verdict"},
                  {.name = "Method"},
                  {.name = "identification", .unit = "%", .group = "explained"},
                  {.name = "hold-out", .unit = "%", .group = "explained"},
                  {.name = "Theil"},
                  {.name = "Equation error", .digits = 3}}};
  for (const CoefficientResult& r : analysis.coefficients) {
    const bool has = r.chosen.has_value();
    table.rows.push_back({.cells = {text_cell(fmt::format("{} {}", r.name, meaning_of(r.coefficient))),
                                    status_cell(status_of(r.verdict), std::string(to_string(r.verdict))),
                                    text_cell(r.method), number_cell(has ? 100.0 * r.identification_fit.r2 : kNaN, 1),
                                    number_cell(r.holdout_fit.count > 0 ? 100.0 * r.holdout_fit.r2 : kNaN, 1),
                                    number_cell(r.holdout_fit.count > 0 ? r.holdout_fit.theil : kNaN, 3),
                                    number_cell(has ? r.error_ratio : kNaN)},
                          .status = status_of(r.verdict)});
  }
  section.blocks.emplace_back(std::move(table));
  // Why one is rejected is in the rows of what was checked, why nothing was estimated is a warning.
  List reasons;
  for (const CoefficientResult& r : analysis.coefficients)
    if (estimation::usable(r.verdict)) reasons.items.push_back(r.reason);
  if (!reasons.items.empty()) section.blocks.emplace_back(std::move(reasons));
  return section;
}

Section other_estimators_section(const FlightAnalysis& analysis) {
  Section section{.title = "Other estimators", .id = "other-estimators", .folded = true};
  const OtherEstimators& others = analysis.others;
  if (others.empty()) return section;
  section.blocks.emplace_back(Paragraph{
      "The same parameters on the same identification segments by other principles. Apart: difference to the "
      "chosen method in units of the two standard errors together; both use the same data, so more than 3 is "
      "a "
      "contradiction and less than 1 is common. Output error knows turbulence only as far as the reconstruction found "
      "the gust; the frequency domain is biased by noise of the regressors as ordinary least squares is."});
  Table table = comparison_table(analysis);
  if (!table.rows.empty()) section.blocks.emplace_back(std::move(table));
  for (const AxisOutputError& run : others.output_error) {
    if (run.attempted && run.estimate.usable()) section.blocks.emplace_back(output_table(run));
  }
  section.blocks.emplace_back(List{.items = others.notes});
  return section;
}

Section structure_section(const FlightAnalysis& analysis) {
  Section section{.title = "Choice of terms", .id = "structure", .folded = true};
  for (const CoefficientResult& r : analysis.coefficients) {
    if (!r.structure) continue;
    Table table{.title = fmt::format("{}: history", name_of(r.coefficient)),
                .caption = r.structure->text,
                .columns = {{.name = "Action"},
                            {.name = "Term"},
                            {.name = "Terms"},
                            {.name = "F", .digits = 3},
                            {.name = "R2", .unit = "%", .digits = 4},
                            {.name = "Change", .unit = "%", .digits = 3},
                            {.name = "PRESS", .digits = 4},
                            {.name = "PSE", .digits = 4},
                            {.name = "Why not"}}};
    for (const estimation::StructureStep& s : r.structure->history) {
      table.rows.push_back(
          {.cells = {text_cell(std::string(estimation::to_string(s.action))), text_cell(s.term),
                     number_cell(static_cast<double>(s.terms), 0), number_cell(s.term.empty() ? kNaN : s.F),
                     number_cell(100.0 * s.r2), number_cell(100.0 * s.r2_change), number_cell(s.press),
                     number_cell(s.pse), text_cell(s.reason)}});
    }
    section.blocks.emplace_back(std::move(table));
  }
  return section;
}

Section uncertainty_section(const UncertaintyReport& report) {
  Section section{.title = "Uncertainty of the measured coefficients", .id = "uncertainty", .folded = true};
  Table table{
      .title = "Error of one measured coefficient",
      .caption =
          "Propagation of distributions (JCGM 101): 95 % of the errors lie between low and high; sigma is the larger "
          "end over 1.96. Alongside it the linear law of propagation, separately for what differs from sample to "
          "sample "
          "(sensors) and what all samples share (mass, geometry, inertia: subject.sigma). Range: standard deviation of "
          "the coefficient itself over the operating range.",
      .columns = {{.name = "Coefficient"},
                  {.name = "sigma", .group = "Monte Carlo"},
                  {.name = "95 % low", .group = "Monte Carlo"},
                  {.name = "95 % high", .group = "Monte Carlo"},
                  {.name = "mean", .digits = 2, .group = "Monte Carlo"},
                  {.name = "sigma", .group = "linear"},
                  {.name = "of sensors", .group = "linear"},
                  {.name = "of the aircraft's constants", .group = "linear"},
                  {.name = "Range", .digits = 3}}};
  for (const CoefficientUncertainty& c : report.coefficients) {
    const double sigma = c.error.sigma;
    table.rows.push_back(
        {.cells = {text_cell(std::string(name_of(c.coefficient))), measured_cell(sigma, sigma),
                   measured_cell(c.error.low, sigma), measured_cell(c.error.high, sigma), number_cell(c.error.mean),
                   measured_cell(c.sigma_linear, sigma), measured_cell(c.sigma_sensors, sigma),
                   measured_cell(c.sigma_body, sigma), number_cell(c.range)}});
  }
  section.blocks.emplace_back(std::move(table));
  section.blocks.emplace_back(Paragraph{report.text + "."});
  return section;
}

}  // namespace veridyn::report
