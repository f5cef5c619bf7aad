#include "veridyn/report/parts/estimate_tables.hpp"

#include <fmt/format.h>

#include <utility>

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

Cell outcome_cell(const estimation::Evidence& row) {
  using estimation::Outcome;
  const std::string word(row.bears_on.empty() && !row.passed() ? "note" : estimation::to_string(row.outcome));
  const Status status = row.bears_on.empty() && !row.passed()  ? Status::kNone
                        : row.outcome == Outcome::kPassed      ? Status::kGood
                        : row.outcome == Outcome::kNotVerified ? Status::kNone
                        : row.outcome == Outcome::kFailed      ? Status::kBad
                                                               : Status::kCaution;
  return {.text = word, .status = status};
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
