#include "veridyn/io/tables/csv_header.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/core/units.hpp"
#include "veridyn/io/tables/csv_cells.hpp"
#include "veridyn/io/tables/date_stamp.hpp"

namespace veridyn::io::internal {
namespace {

// Names under which stamps are known, with their unit. '?': microseconds, or seconds with a decimal point.
struct TimeName {
  std::string_view name;
  std::string_view unit;
};
constexpr TimeName kTimeNames[] = {{"time", "s"},          {"t", "s"},
                                   {"t_s", "s"},           {"time_s", "s"},
                                   {"seconds", "s"},       {"sec", "s"},
                                   {"time_sec", "s"},      {"timems", "ms"},
                                   {"time_ms", "ms"},      {"t_ms", "ms"},
                                   {"timeus", "us"},       {"time_us", "us"},
                                   {"t_us", "us"},         {"timestamp_us", "us"},
                                   {"timestamp_ms", "ms"}, {"timestamp_s", "s"},
                                   {"timestamp_ns", "ns"}, {"time_ns", "ns"},
                                   {"millis", "ms"},       {"timestamp", "?"}};

using Names = std::vector<std::string>;

std::optional<std::size_t> column_of(const Names& names, std::string_view name) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (lower(names[i]) == name) return i;
  }
  return std::nullopt;
}

/// The column that the options name, or that of a log whose `time` is something else; its unit where the log fixes it.
std::pair<std::optional<std::size_t>, std::string> named_column(const Names& names, const CsvOptions& options,
                                                                const std::string& place) {
  const auto has = [&](std::string_view name) { return column_of(names, name).has_value(); };
  if (!options.time_column.empty()) {
    const auto found = std::find(names.begin(), names.end(), options.time_column);
    if (found == names.end()) {
      throw InputError(place, fmt::format("no column '{}' for the time{}", options.time_column,
                                          suggestion(options.time_column, names)));
    }
    return {at(found - names.begin()), ""};
  }
  if (has("timems") && has("week") && has("t")) return {column_of(names, "t"), "ms"};
  if (has("date") && has("time") && has("millis")) return {column_of(names, "millis"), ""};
  return {std::nullopt, ""};
}

/// A column `time...[unit]`, else the first that holds dates.
std::optional<std::size_t> column_by_content(const std::vector<Header>& headers, const Names& first_cells) {
  const Unit second = parse_unit("s");
  for (std::size_t i = 0; i < headers.size(); ++i) {
    if (headers[i].unit.empty() || lower(headers[i].name).rfind("time", 0) != 0) continue;
    if (parse_unit(headers[i].unit).same_dimension(second)) return i;
  }
  for (std::size_t i = 0; i < headers.size(); ++i) {
    if (parse_date_stamp(first_cells[i])) return i;
  }
  return std::nullopt;
}

}  // namespace

Header split_header(const std::string& cell, bool our_own, const std::string& place) {
  Header header{cell, ""};
  if (cell.empty() || cell.back() != ']') return header;
  const std::size_t open = cell.rfind('[');
  if (open == std::string::npos || open == 0) return header;
  const std::string unit = cell.substr(open + 1, cell.size() - open - 2);
  const std::string name(trimmed(std::string_view(cell).substr(0, open)));
  // In files by others "control[3]" is an element, in ours the last brackets always hold a unit.
  const bool element = !unit.empty() && unit.find_first_not_of("0123456789") == std::string::npos;
  if (!our_own && element) return header;
  try {
    (void)parse_unit(unit);
  } catch (const InputError& error) {
    if (our_own) throw InputError(fmt::format("{}: column '{}'", place, name), error.what());
    return header;
  }
  return {name, unit.empty() ? "1" : unit};
}

TimeChoice choose_time(const std::vector<Header>& headers, const CsvOptions& options, std::string_view first_row,
                       char delimiter, const std::string& place) {
  if (options.rate > 0.0) return {};
  Names first_cells, names;
  CellReader first(first_row, delimiter);
  while (first_cells.size() < headers.size() && !first.at_end()) first_cells.push_back(first.text());
  first_cells.resize(headers.size());
  for (const Header& header : headers) names.push_back(header.name);
  auto [column, unit] = named_column(names, options, place);
  for (const TimeName& known : kTimeNames) {
    if (column && lower(names[*column]) != known.name) continue;
    const auto found = column_of(names, known.name);
    if (!found) continue;
    column = column ? column : found;
    if (unit.empty()) unit = known.unit;
    break;
  }
  if (!column) column = column_by_content(headers, first_cells);
  if (!column) {
    throw InputError(place, fmt::format("no time column found among {}; name it in the study ([data.time] column = "
                                        "\"...\"), or call it 'time[s]'",
                                        shown(fmt::format("{}", fmt::join(names, ", ")))));
  }
  if (parse_date_stamp(first_cells[*column])) return {*column, 1.0, true};
  if (!headers[*column].unit.empty()) unit = headers[*column].unit;
  if (!options.time_unit.empty()) unit = options.time_unit;
  if (unit == "?") unit = first_cells[*column].find('.') != std::string::npos ? "s" : "us";
  if (unit.empty()) unit = "s";
  try {
    return {*column, parse_unit_like(unit, parse_unit("s")).scale};
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: column '{}'", place, names[*column]), error.what());
  }
}

}  // namespace veridyn::io::internal
