#include "veridyn/estimation/judgement/check_table.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

namespace veridyn::estimation {
namespace {

constexpr std::array kAllOf{CheckedOf::kRecording, CheckedOf::kFlight,     CheckedOf::kCoefficient,
                            CheckedOf::kDrive,     CheckedOf::kVehicle,    CheckedOf::kLimb,
                            CheckedOf::kAny,       CheckedOf::kRegression, CheckedOf::kTracking};

/// A limit with its unit; a unit of words, as "reading over truth", is in the column of what is compared.
std::string with_unit(double limit, std::string_view unit) {
  const bool is_plain = unit.find(' ') != std::string_view::npos || unit == "1" || unit == "p" || unit == "R2";
  return fmt::format("{:.4g}{}{}", limit, is_plain || unit.empty() ? "" : " ", is_plain ? "" : unit);
}

/// Of a cell of a table.
std::string in_cell(std::string_view text) {
  std::string cell;
  for (const char c : text) cell += c == '|' ? std::string("\\|") : std::string(1, c);
  return cell;
}

}  // namespace

std::string_view to_string(CheckedOf of) {
  switch (of) {
    case CheckedOf::kRecording:
      return "any recording";
    case CheckedOf::kFlight:
      return "the recording of a flight";
    case CheckedOf::kCoefficient:
      return "a coefficient of an aircraft";
    case CheckedOf::kDrive:
      return "the recording of a drive";
    case CheckedOf::kVehicle:
      return "the parameters of a vehicle";
    case CheckedOf::kLimb:
      return "the tasks of a limb";
    case CheckedOf::kRegression:
      return "a linear regression";
    case CheckedOf::kTracking:
      return "what is tracked on line";
    case CheckedOf::kAny:
      break;
  }
  return "any estimate";
}

std::string rule_of(const CheckInfo& info, Outcome outcome) {
  const bool failed = outcome == Outcome::kFailed;
  const double low = failed ? info.tolerance.lowest : info.tolerance.low;
  const double high = failed ? info.tolerance.highest : info.tolerance.high;
  const std::string_view words = failed ? info.failed : info.care;
  std::string rule;
  if (std::isfinite(low) && std::isfinite(high))
    rule = fmt::format("outside of {:.4g} to {}", low, with_unit(high, info.unit));
  else if (std::isfinite(low))
    rule = "below " + with_unit(low, info.unit);
  else if (std::isfinite(high))
    rule = "above " + with_unit(high, info.unit);
  if (!words.empty()) rule += fmt::format("{}{}", rule.empty() ? "" : "; ", words);
  return rule;
}

std::string limit_in_words(const Evidence& row, double factor) {
  const Tolerance& t = info_of(row.check).tolerance;
  const double limit = factor * row.limit;
  if (!std::isfinite(limit)) return "–";
  const bool below = std::isfinite(t.low) || std::isfinite(t.lowest);
  const bool above = std::isfinite(t.high) || std::isfinite(t.highest);
  for (const auto& [low, high] : {std::pair(t.low, t.high), std::pair(t.lowest, t.highest)})
    if (std::isfinite(low) && std::isfinite(high) && (row.limit == low || row.limit == high))
      return fmt::format("{:.4g} to {:.4g}", factor * low, factor * high);
  // Without limits of the table: on which side of its limit a value passes follows from what came of the row.
  const bool beyond = row.outcome == Outcome::kPassed ? row.value < row.limit : row.value > row.limit;
  const bool at_most = below == above ? beyond : above;
  return fmt::format("at {} {:.4g}", at_most ? "most" : "least", limit);
}

std::string source_of(const CheckInfo& info) {
  using Kind = LimitSource::Kind;
  switch (info.source.kind) {
    case Kind::kCitation:
      return fmt::format("{}", info.source.text);
    case Kind::kCampaign:
      return fmt::format("counted: {}", info.source.text);
    case Kind::kLevel:
      return fmt::format("level of a test: {}", info.source.text);
    case Kind::kDerived:
      return fmt::format("derived: {}", info.source.text);
    case Kind::kLogic:
      break;
  }
  return {};
}

std::string list_of(Purposes purposes) {
  std::string list;
  for (const Purpose purpose : kPurposes)
    if (purposes.contains(purpose)) list += fmt::format("{}{}", list.empty() ? "" : ", ", to_string(purpose));
  return list;
}

std::vector<const CheckInfo*> checks_of(CheckedOf of) {
  std::vector<const CheckInfo*> found;
  for (const CheckInfo& info : all_checks())
    if (info.of == of && info.check != Check::kUnknown) found.push_back(&info);
  return found;
}

std::string checks_in_markdown() {
  std::string text;
  for (const CheckedOf of : kAllOf) {
    text += fmt::format("### Of {}\n| row | what is compared | with care | failed | bears on | limits from |\n",
                        to_string(of));
    text += "|---|---|---|---|---|---|\n";
    for (const CheckInfo* info : checks_of(of)) {
      const std::string unit =
          info->unit.empty() || info->unit == "1" ? std::string() : fmt::format(" [{}]", info->unit);
      std::string source = source_of(*info);
      if (!info->key.empty()) source += fmt::format("{}set by `{}`", source.empty() ? "" : "; ", info->key);
      text += fmt::format("| {} | {}{} | {} | {} | {} | {} |\n", in_cell(info->name), in_cell(info->compares), unit,
                          in_cell(rule_of(*info, Outcome::kCare)), in_cell(rule_of(*info, Outcome::kFailed)),
                          list_of(info->bears_on), in_cell(source));
    }
    text += "\n";
  }
  return text;
}

}  // namespace veridyn::estimation
