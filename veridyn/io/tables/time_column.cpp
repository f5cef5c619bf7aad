#include "veridyn/io/tables/time_column.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/rank.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/core/units.hpp"
#include "veridyn/io/tables/csv_cells.hpp"
#include "veridyn/io/tables/date_stamp.hpp"
#include "veridyn/io/tables/unit_words.hpp"

namespace veridyn::io::internal {
namespace {

/// Rows of which the stamps are looked at to tell their unit.
constexpr std::size_t kRowsLookedAt = 1000;

/// Names under which stamps are known, the first that is there counts, with their unit; empty: the name says none.
struct TimeName {
  std::string_view name;
  std::string_view unit;
};
constexpr TimeName kTimeNames[] = {{"time", ""},
                                   {"t_s", "s"},
                                   {"time_s", "s"},
                                   {"seconds", "s"},
                                   {"sec", "s"},
                                   {"secs", "s"},
                                   {"time_sec", "s"},
                                   {"timems", "ms"},
                                   {"time_ms", "ms"},
                                   {"t_ms", "ms"},
                                   {"timeus", "us"},
                                   {"time_us", "us"},
                                   {"t_us", "us"},
                                   {"timestamp_us", "us"},
                                   {"timestamp_ms", "ms"},
                                   {"timestamp_s", "s"},
                                   {"timestamp_ns", "ns"},
                                   {"time_ns", "ns"},
                                   {"t_ns", "ns"},
                                   {"millis", "ms"},
                                   {"timestamp", ""},
                                   {"time_stamp", ""},
                                   // T is a temperature where any of these stands.
                                   {"t", ""},
                                   {"times", ""},
                                   {"timestamps", ""},
                                   {"session_time", "s"},
                                   {"_totl,_time", "s"},
                                   {"missn,_time", "s"},
                                   {"_real,_time", "s"},
                                   {"elapsed_time", ""},
                                   {"time_elapsed", ""},
                                   {"elapsed", ""},
                                   {"zeit", ""},
                                   {"zeit_s", "s"},
                                   {"zeit_ms", "ms"},
                                   {"temps", ""},
                                   {"tiempo", ""},
                                   {"tempo", ""},
                                   {"tijd", ""}};

/// Small letters, blanks as underscores: "Elapsed Time" is "elapsed_time".
std::string plain(std::string_view name) {
  std::string text = lower(trimmed(name));
  std::replace(text.begin(), text.end(), ' ', '_');
  return text;
}

std::optional<std::size_t> column_of(std::span<const std::string> names, std::string_view name) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (plain(names[i]) == name) return i;
  }
  return std::nullopt;
}

/// The column of a log whose `time` is something else, and the unit that the log fixes.
std::pair<std::optional<std::size_t>, std::string> column_of_known_log(std::span<const std::string> names) {
  const auto has = [&](std::string_view name) { return column_of(names, name).has_value(); };
  if (has("timems") && has("week") && has("t")) return {column_of(names, "t"), "ms"};
  // Betaflight's explorer and decoder.
  if (has("loopiteration") && has("time")) return {column_of(names, "time"), "us"};
  if (has("date") && has("time") && has("millis")) return {column_of(names, "millis"), ""};
  return {std::nullopt, ""};
}

/// A column `time...[unit]`, else the first that holds dates or times of day.
std::optional<std::size_t> column_by_content(const std::vector<Header>& headers,
                                             const std::vector<std::string>& first_cells) {
  const Unit second = parse_unit("s");
  for (std::size_t i = 0; i < headers.size(); ++i) {
    if (headers[i].unit.empty() || lower(headers[i].name).rfind("time", 0) != 0) continue;
    if (parse_unit(headers[i].unit).same_dimension(second)) return i;
  }
  for (const auto kind : {TextStamp::Kind::kDate, TextStamp::Kind::kTimeOfDay}) {
    for (std::size_t i = 0; i < headers.size(); ++i) {
      const auto stamp = parse_text_stamp(first_cells[i]);
      if (stamp && stamp->kind == kind) return i;
    }
  }
  return std::nullopt;
}

/// The first cell of each column that is not empty, among the first rows.
std::vector<std::string> first_filled_cells(std::string_view rows, std::size_t columns, CellStyle style) {
  std::vector<std::string> cells(columns);
  CellReader reader(rows, style);
  for (std::size_t row = 0; row < kRowsLookedAt && !reader.at_end(); ++row) {
    if (const char first = *reader.position(); first == '\n' || first == '\r' || first == '#' || first == '%') {
      static_cast<void>(reader.line());
      continue;
    }
    for (std::size_t i = 0; !reader.at_end(); ++i) {
      std::string cell = reader.text();
      if (i < columns && cells[i].empty()) cells[i] = std::move(cell);
      if (reader.last_cell_of_row()) break;
    }
    if (std::ranges::find(cells, "") == cells.end()) break;
  }
  return cells;
}

/// The median of what neighbours differ by, where they do; 0 where none does.
double median_step(std::span<const double> stamps) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    if (stamps[i] > stamps[i - 1]) steps.push_back(stamps[i] - stamps[i - 1]);
  return steps.empty() ? 0.0 : upper_median(steps);
}

/// The unit in which the numbers are those of a Unix clock in the years 2000 to 2100; empty: in none.
std::string unix_unit(std::span<const double> stamps) {
  constexpr double kYear2000 = 946684800.0;
  constexpr double kYear2100 = 4102444800.0;
  for (const auto& [unit, scale] : {std::pair("ns", 1e-9), std::pair("us", 1e-6), std::pair("ms", 1e-3)}) {
    if (stamps.front() * scale > kYear2000 && stamps.back() * scale < kYear2100) return unit;
  }
  return {};
}

constexpr const char* kHowToSay = "say otherwise with time = { unit = \"...\" } in [data]";

/// Stamps of the first rows that are numbers.
std::vector<double> first_stamps(std::string_view rows, std::size_t column, std::size_t columns, CellStyle style) {
  std::vector<double> stamps;
  CellReader reader(rows, style);
  while (!reader.at_end() && stamps.size() < kRowsLookedAt) {
    if (const char first = *reader.position(); first == '\n' || first == '\r' || first == '#' || first == '%') {
      static_cast<void>(reader.line());
      continue;
    }
    for (std::size_t i = 0; i < columns && !reader.at_end(); ++i) {
      double value = 0.0;
      bool infinite = false;
      if (!reader.number(value)) value = reader.unusual(infinite).value_or(kMissing);
      if (i == column && std::isfinite(value)) stamps.push_back(value);
      if (reader.last_cell_of_row()) break;
    }
    if (!reader.last_cell_of_row()) static_cast<void>(reader.line());
  }
  return stamps;
}

}  // namespace

std::optional<TextStamp> parse_text_stamp(std::string_view text) {
  if (const auto date = parse_date_stamp(text))
    return TextStamp{TextStamp::Kind::kDate, date->day, date->second, date->utc};
  if (const auto second = parse_time_of_day(text)) return TextStamp{TextStamp::Kind::kTimeOfDay, 0, *second, false};
  double value = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || !std::isfinite(value)) return std::nullopt;
  const auto word = unit_in_words(text.substr(at(stop - text.data())));
  const Unit unit = word ? parse_unit(*word) : Unit{};
  if (!unit.same_dimension(parse_unit("s"))) return std::nullopt;
  return TextStamp{TextStamp::Kind::kDuration, 0, unit.to_si(value), false};
}

std::optional<std::string_view> unit_of_time_name(std::string_view name) {
  const std::string text = plain(name);
  for (const TimeName& known : kTimeNames)
    if (known.name == text) return known.unit;
  return std::nullopt;
}

AssumedUnit assume_time_unit(std::string_view name, std::span<const double> stamps, const std::string& place) {
  if (stamps.empty()) return {};
  const double step = median_step(stamps);
  const bool whole = std::all_of(stamps.begin(), stamps.end(), [](double t) { return t == std::floor(t); });
  if (const std::string unit = unix_unit(stamps); !unit.empty()) {
    return {unit,
            fmt::format("the stamps of '{}' are taken as {} of a Unix clock, which puts them between 2000 and 2100; {}",
                        name, unit, kHowToSay)};
  }
  const bool px4 = plain(name) == "timestamp";
  if (!whole) {
    if (step < 2.0) return {};
    return {"s", fmt::format("the stamps of '{}' are taken as seconds, and rows then are {:.3g} s apart; {}", name,
                             step, kHowToSay)};
  }
  if (px4 && (step == 0.0 || step >= 100.0)) return {.unit = "us"};
  if (step < 2.0) return {};
  struct Candidate {
    const char* unit;
    double scale;
  };
  constexpr double kClosest_s = 1.0 / 2000.0, kFarthest_s = 2.0;
  std::vector<Candidate> fitting;
  for (const Candidate c : {Candidate{"ms", 1e-3}, Candidate{"us", 1e-6}, Candidate{"ns", 1e-9}}) {
    if (step * c.scale >= kClosest_s && step * c.scale < kFarthest_s) fitting.push_back(c);
  }
  if (fitting.empty()) return {"s", fmt::format("the stamps of '{}' are taken as seconds; {}", name, kHowToSay)};
  if (fitting.size() > 1) {
    throw InputError(place, fmt::format("the stamps of '{}' are {:g} apart: {:.3g} Hz in {}, or {:.3g} Hz in {}? Say "
                                        "which: time = {{ unit = \"{}\" }} in [data]",
                                        name, step, 1.0 / (step * fitting[0].scale), fitting[0].unit,
                                        1.0 / (step * fitting[1].scale), fitting[1].unit, fitting[0].unit));
  }
  return {fitting[0].unit,
          fmt::format("the stamps of '{}' are taken as {}: whole numbers {:g} apart, which gives {:.3g} "
                      "rows per second; {}",
                      name, fitting[0].unit, step, 1.0 / (step * fitting[0].scale), kHowToSay)};
}

std::optional<std::size_t> find_time_column(std::span<const std::string> names, const TableOptions& options,
                                            const std::string& place) {
  if (!options.time_column.empty()) {
    const auto found = std::find(names.begin(), names.end(), options.time_column);
    if (found == names.end()) {
      throw InputError(place, fmt::format("no column '{}' for the time{}", options.time_column,
                                          suggestion(options.time_column, names)));
    }
    return at(found - names.begin());
  }
  for (const TimeName& known : kTimeNames)
    if (const auto found = column_of(names, known.name)) return found;
  return std::nullopt;
}

TimeChoice time_scale(const Header& header, const TableOptions& options, std::span<const double> stamps,
                      const std::string& place) {
  TimeChoice choice;
  std::string unit = !options.time_unit.empty() ? options.time_unit : header.unit;
  if (unit.empty()) unit = unit_of_time_name(header.name).value_or("");
  if (unit.empty()) {
    AssumedUnit assumed = assume_time_unit(header.name, stamps, place);
    unit = std::move(assumed.unit);
    choice.note = std::move(assumed.note);
  }
  try {
    choice.scale = parse_unit_like(unit, parse_unit("s")).scale;
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: column '{}'", place, header.name), error.what());
  }
  return choice;
}

TimeChoice choose_time(const std::vector<Header>& headers, const TableOptions& options, std::string_view rows,
                       CellStyle style, const std::string& place) {
  if (options.rate > 0.0) return {};
  const std::vector<std::string> first_cells = first_filled_cells(rows, headers.size(), style);
  std::vector<std::string> names;
  for (const Header& header : headers) names.push_back(header.name);
  std::optional<std::size_t> column;
  std::string unit;
  if (options.time_column.empty()) std::tie(column, unit) = column_of_known_log(names);
  if (!column) column = find_time_column(names, options, place);
  if (!column) column = column_by_content(headers, first_cells);
  if (!column) {
    throw InputError(place, fmt::format("no time column found among {}; name it in the study ([data.time] column = "
                                        "\"...\"), or call it 'time[s]'",
                                        shown(fmt::format("{}", fmt::join(names, ", ")))));
  }
  TimeChoice choice;
  if (parse_text_stamp(first_cells[*column])) {
    choice.texts = true;
  } else {
    Header header = headers[*column];
    if (header.unit.empty()) header.unit = unit;
    choice = time_scale(header, options, first_stamps(rows, *column, headers.size(), style), place);
  }
  choice.column = *column;
  return choice;
}

}  // namespace veridyn::io::internal
