#include "veridyn/report/parts/estimate_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/judgement/check_table.hpp"
#include "veridyn/report/document/number_format.hpp"

namespace veridyn::report {

Status status_of(estimation::ParameterStatus status) { return status_from_name(estimation::to_string(status)); }

std::vector<Cell> interval_cells(double value, double sigma, double low95, double high95) {
  return {measured_cell(value, sigma), measured_cell(sigma, sigma), measured_cell(low95, sigma),
          measured_cell(high95, sigma)};
}

std::vector<Column> parameter_columns(bool with_truth) {
  std::vector<Column> columns{{.name = "parameter", .align = Align::kLeft},
                              {.name = "value"},
                              {.name = "sigma", .digits = 2},
                              {.name = "95 % from"},
                              {.name = "to"},
                              {.name = "unit", .align = Align::kLeft},
                              {.name = "status"}};
  if (with_truth) columns.push_back({.name = "truth"});
  return columns;
}

Row parameter_row(const estimation::Parameter& p, double factor, std::string unit) {
  const double sigma = p.sigma * factor;
  return {.cells = {text_cell(p.name), measured_cell(p.value * factor, sigma), number_cell(sigma),
                    measured_cell(p.low95 * factor, sigma), measured_cell(p.high95 * factor, sigma),
                    text_cell(std::move(unit)), status_cell(status_of(p.status))},
          .status = status_of(p.status)};
}

std::vector<Column> evidence_columns() {
  return {{.name = "check", .align = Align::kLeft},         {.name = "value", .align = Align::kRight, .digits = 3},
          {.name = "limit", .align = Align::kLeft},         {.name = "unit", .align = Align::kLeft},
          {.name = "what was seen", .align = Align::kLeft}, {.name = "bears on", .align = Align::kLeft}};
}

Row evidence_row(const estimation::Evidence& row, bool said) {
  const ReadableNumber unit = readable(1.0, std::string(estimation::unit_of(row)));
  estimation::Evidence shown = row;
  for (double* number : {&shown.value, &shown.sigma, &shown.limit}) *number *= unit.value;
  const std::string name(estimation::name_of(row));
  Cell value = number_cell(shown.value);
  if (row.sigma > 0.0)
    value.text = fmt::format("{} ± {}", format_number(shown.value, 3), format_number(shown.sigma, 2));
  std::string limit;  // on one line
  for (const char c : estimation::limit_in_words(row, unit.value))
    limit += c == ' ' ? std::string("\u00a0") : std::string(1, c);
  const bool on_all =
      std::ranges::all_of(estimation::kPurposes, [&](estimation::Purpose p) { return row.bears_on.contains(p); });
  return {.cells = {text_cell(estimation::mentions(name, row.about) ? name : fmt::format("{}: {}", row.about, name)),
                    std::move(value), text_cell(std::move(limit)), text_cell(unit.unit),
                    text_cell(said ? "see the top of this page" : estimation::says(row)),
                    text_cell(on_all                 ? "all"
                              : row.bears_on.empty() ? "nothing"
                                                     : estimation::list_of(row.bears_on))}};
}

std::string change_words(const estimation::Change& change) {
  switch (change.kind) {
    case estimation::ChangeKind::kMean:
      return fmt::format("innovation moved by {:.1f} sigma", change.shift);
    case estimation::ChangeKind::kSpread:
      return fmt::format("innovation grew {:.1f} times", change.shift);
    case estimation::ChangeKind::kParameter:
      break;
  }
  return fmt::format("moved to {:.2g} times its value", 1.0 + change.shift);
}

Row change_row(std::string what, const estimation::Change& change) {
  return {.cells = {text_cell(std::move(what)), number_cell(change.detected_s, 1), number_cell(change.began_s, 1),
                    text_cell(change_words(change))}};
}

std::vector<Column> change_columns(std::string what, std::string noticed) {
  return {{.name = std::move(what), .align = Align::kLeft},
          {.name = "detected", .unit = "s"},
          {.name = "began", .unit = "s"},
          {.name = std::move(noticed), .align = Align::kLeft}};
}

}  // namespace veridyn::report
