#include "veridyn/io/tables/csv_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "veridyn/core/error.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/core/units.hpp"
#include "veridyn/io/log/log.hpp"
#include "veridyn/io/tables/csv_cells.hpp"
#include "veridyn/io/tables/time_column.hpp"
#include "veridyn/io/tables/unit_words.hpp"

namespace veridyn::io::internal {
namespace {

bool is_digits(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// "Time, sec", "pitch,__deg", "V/(m/s)": a unit after the last comma, or the first slash that ends a name.
Header split_at_sign(const std::string& cell) {
  Header whole{printable(cell), ""};
  if (const std::size_t comma = cell.rfind(','); comma != std::string::npos && comma > 0) {
    std::string_view text = std::string_view(cell).substr(comma + 1);
    const bool apart = text.starts_with(' ');
    while (!text.empty() && (text.front() == '_' || text.front() == ' ')) text.remove_prefix(1);
    const std::string name = printable(trimmed(std::string_view(cell).substr(0, comma)));
    const auto unit = is_digits(text) ? std::nullopt : unit_of_column(text, name);
    if (unit) return {apart ? name : whole.name, *unit};
    return whole;
  }
  // "F/N": a name that is a unit itself ("deg/s") is a quotient of two.
  const std::size_t slash = cell.find('/');
  if (slash == std::string::npos || slash == 0) return whole;
  const std::string name = printable(trimmed(std::string_view(cell).substr(0, slash)));
  std::string_view text = trimmed(std::string_view(cell).substr(slash + 1));
  if (text.size() > 2 && text.front() == '(' && text.back() == ')') text = text.substr(1, text.size() - 2);
  if (unit_in_words(name) || is_digits(text)) return whole;
  const auto unit = unit_of_column(text, name);
  return unit ? Header{name, *unit} : whole;
}

}  // namespace

Header split_header(const std::string& cell, bool our_own, const std::string& place) {
  Header header{printable(cell), ""};
  const bool round = !our_own && cell.ends_with(')');
  if (!our_own && (cell.find("/(") != std::string::npos || cell.find("/ (") != std::string::npos))
    return split_at_sign(cell);
  if (!round && !cell.ends_with(']')) return our_own ? header : split_at_sign(cell);
  const std::size_t open = cell.rfind(round ? '(' : '[');
  if (open == std::string::npos || open == 0) return header;
  const std::string unit = cell.substr(open + 1, cell.size() - open - 2);
  const std::string name = printable(trimmed(std::string_view(cell).substr(0, open)));
  if (our_own) {
    try {
      static_cast<void>(parse_unit(unit));
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: column '{}'", place, name), error.what());
    }
    return {name, unit.empty() ? "1" : unit};
  }
  if (unit.empty() && !round) return {name, "1"};
  // "control[3]" is an element, "V(2)" the second of two.
  const auto known = is_digits(unit) ? std::nullopt : unit_of_column(unit, name);
  return known ? Header{name, *known} : header;
}

std::vector<std::string> cells_of(std::string_view line, char delimiter) {
  if (delimiter == ' ') return blank_separated(line);
  CellReader reader(line, delimiter);
  std::vector<std::string> cells;
  do {
    cells.push_back(reader.text());
  } while (!reader.last_cell_of_row() && !reader.at_end());
  if (cells.size() > 1 && cells.back().empty()) cells.pop_back();
  return cells;
}

std::vector<std::string> blank_separated(std::string_view line) {
  CellReader reader(line, ' ');
  std::vector<std::string> cells;
  while (!reader.at_end()) {
    std::string cell = reader.text();
    const bool opens = cell.starts_with('(') || cell.starts_with('[') || cell.starts_with("/(");
    const bool within = !cells.empty() && cells.back().find_first_of("([") != std::string::npos &&
                        cells.back().find_first_of(")]") == std::string::npos;
    if (!cells.empty() && (opens || within)) {
      cells.back() += ' ' + cell;
    } else if (!cell.empty()) {
      cells.push_back(std::move(cell));
    }
  }
  return cells;
}

bool holds_only_data(const std::vector<std::string>& cells, bool decimal_comma) {
  bool any = false;
  for (const std::string& cell : cells) {
    bool infinite = false;
    if (!parse_text_stamp(cell) && !unusual_number(cell, infinite, decimal_comma)) return false;
    any = any || !cell.empty();
  }
  return any;
}

std::vector<std::string> row_of_units(const std::vector<std::string>& cells) {
  std::vector<std::string> units;
  bool any = false;
  for (const std::string& cell : cells) {
    std::string_view text = cell;
    if (text.size() > 1 && (text.front() == '[' || text.front() == '(')) text = text.substr(1, text.size() - 2);
    bool infinite = false;
    const bool none = text.empty() || text == "-";
    const auto unit = none ? std::optional<std::string>("") : unit_in_words(text);
    if (!unit || (!none && unusual_number(text, infinite))) return {};
    any = any || !none;
    units.push_back(*unit);
  }
  if (!any) return {};
  return units;
}

std::vector<std::string> row_of_units_and_words(const std::vector<std::string>& cells) {
  std::vector<std::string> units;
  std::size_t known = 0, filled = 0;
  for (const std::string& cell : cells) {
    std::string_view text = cell;
    if (text.size() > 1 && (text.front() == '[' || text.front() == '(')) text = text.substr(1, text.size() - 2);
    bool infinite = false;
    const bool none = text.empty() || text == "-";
    if (!none && unusual_number(text, infinite)) return {};
    units.push_back(none ? "" : unit_in_words(text).value_or(""));
    known += units.back().empty() ? 0U : 1U;
    filled += none ? 0U : 1U;
  }
  if (known < 2 || 2 * known < filled) return {};
  return units;
}

std::vector<std::string> number_repeated(std::vector<Header>& headers) {
  std::vector<std::string> repeated;
  const auto taken = [&](const std::string& name, std::size_t before) {
    return std::any_of(headers.begin(), headers.begin() + before,
                       [&](const Header& header) { return header.name == name; });
  };
  std::map<std::string, std::size_t> count;
  for (std::size_t i = 0; i < headers.size(); ++i) {
    const std::string name = headers[i].name;
    if (++count[name] == 1 && !taken(name, i)) continue;
    do {
      headers[i].name = fmt::format("{}({})", name, std::max<std::size_t>(2, count[name]));
      if (!taken(headers[i].name, i)) break;
      ++count[name];
    } while (true);
    repeated.push_back(headers[i].name);
  }
  return repeated;
}

}  // namespace veridyn::io::internal
