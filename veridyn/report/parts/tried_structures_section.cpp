#include "veridyn/report/parts/tried_structures_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <utility>

#include "veridyn/report/document/number_format.hpp"

namespace veridyn::report {
namespace {

using estimation::Estimate;
using estimation::Parameter;
using estimation::StructureTrial;

std::string sentence(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text + ".";
}

Cell taken_cell(const StructureTrial& trial) {
  if (trial.taken) return status_cell(Status::kGood, "taken");
  return trial.obstacle.empty() ? text_cell("") : status_cell(Status::kCaution, "cannot be taken");
}

std::vector<Column> columns_of(const StructureTrial& shown) {
  std::vector<Column> columns{{.name = "structure", .align = Align::kLeft},
                              {.name = ""},
                              {.name = "gained", .group = "log-likelihood"},
                              {.name = "needed", .digits = 3, .group = "log-likelihood"}};
  const ReadableNumber holdout = readable(1.0, shown.holdout_unit);
  if (!shown.holdout_quantity.empty())
    columns.push_back({.name = shown.holdout_quantity, .unit = holdout.unit, .digits = 3, .group = "hold-out rms"});
  for (const Parameter& p : shown.parameters) {
    const std::string unit = readable(1.0, p.unit, p.name).unit;
    // With the group: repeated by both columns it would make the table too wide for a page.
    const std::string group = unit.empty() ? p.name : fmt::format("{} [{}]", p.name, unit);
    columns.push_back({.name = "value", .group = group});
    columns.push_back({.name = "sigma", .group = group});
  }
  return columns;
}

/// A row as `shown` has columns: what a trial without a fit does not have is missing.
Row row_of(const StructureTrial& trial, const StructureTrial& shown) {
  Row row{.cells = {text_cell(trial.name), taken_cell(trial), number_cell(trial.log_likelihood_gain, 1),
                    number_cell(trial.needed_gain)}};
  if (!shown.holdout_quantity.empty())
    row.cells.push_back(number_cell(readable(trial.holdout_rmse, trial.holdout_unit).value));
  for (const Parameter& of_shown : shown.parameters) {
    const Parameter* p = estimation::find_parameter(trial.parameters, of_shown.name);
    const double factor = readable(1.0, of_shown.unit, of_shown.name).value;
    const double value = p != nullptr ? p->value * factor : kNaN, sigma = p != nullptr ? p->sigma * factor : kNaN;
    row.cells.push_back(measured_cell(value, sigma));
    row.cells.push_back(measured_cell(sigma, sigma));
  }
  return row;
}

Table trial_table(const std::vector<StructureTrial>& trials) {
  const auto fitted = [](const StructureTrial& trial) { return !trial.parameters.empty(); };
  const auto first = std::ranges::find_if(trials, fitted);
  const StructureTrial& shown = first != trials.end() ? *first : trials.front();
  Table table{.title = "Structures that were tried",
              .caption =
                  "Each was fitted to the data of the identification, in few steps, to compare. What it gained is over "
                  "the first; one is taken where its probability against the one taken before it is above 95 %, up to "
                  "roll also where it gains more than is needed over that one, which the autocorrelation of its "
                  "residual raises, and predicts the hold-out no worse. Where roll is likelier the residuals of all "
                  "are whitened. The one that was "
                  "taken was then fitted to the end: the table of parameters has its values and intervals.",
              .columns = columns_of(shown),
              .sortable = false};
  for (const StructureTrial& trial : trials) table.rows.push_back(row_of(trial, shown));
  return table;
}

}  // namespace

Section tried_structures_section(const Estimate& estimate) {
  Section section{.title = "Structure", .id = "structure"};
  const std::vector<StructureTrial>& trials = estimate.tried_structures;
  if (trials.empty()) return section;
  section.blocks.emplace_back(Paragraph{estimate.structure_reason.empty()
                                            ? fmt::format("The study fixes it: {}.", estimate.structure)
                                            : sentence(estimate.structure_reason)});
  // One alone compares with nothing.
  if (trials.size() > 1) section.blocks.emplace_back(trial_table(trials));
  for (const StructureTrial& trial : trials) {
    if (!trial.obstacle.empty())
      section.blocks.emplace_back(Paragraph{fmt::format("{}: {}", trial.name, trial.obstacle), Tone::kNote});
  }
  return section;
}

}  // namespace veridyn::report
