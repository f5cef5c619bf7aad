#include "veridyn/io/tables/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/io/tables/csv_cells.hpp"

namespace veridyn::io {
namespace {

std::string_view unquoted(std::string_view text) {
  return text.size() >= 2 && text.front() == '"' && text.back() == '"' ? text.substr(1, text.size() - 2) : text;
}

std::vector<std::string_view> cells_of(std::string_view line, char delimiter) {
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t end = line.find(delimiter);
    cells.push_back(unquoted(trimmed(line.substr(0, end))));
    if (end == std::string_view::npos) return cells;
    line.remove_prefix(end + 1);
  }
}

}  // namespace

std::vector<std::string> Table::names() const {
  std::vector<std::string> all;
  for (const TableColumn& c : columns) all.push_back(c.name);
  return all;
}

const TableColumn& Table::at(std::string_view name) const {
  const auto found = std::find_if(columns.begin(), columns.end(), [&](const TableColumn& c) { return c.name == name; });
  if (found == columns.end())
    throw InputError(source, fmt::format("has no column '{}'{}", name, suggestion(name, names(), columns.size())));
  return *found;
}

Table parse_table(std::string_view text, std::string source) {
  Table table;
  table.source = std::move(source);
  std::vector<Unit> recorded;
  std::size_t number = 0;
  char delimiter = ',';
  bool closed = false;  // a delimiter after the last cell of every row
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = unquoted(trimmed(text.substr(0, end)));
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    ++number;
    if (line.empty() || line.front() == '#') continue;
    const std::string place = fmt::format("{}:{}", table.source, number);
    if (table.columns.empty()) delimiter = internal::guess_delimiter(line);
    std::vector<std::string_view> cells = cells_of(line, delimiter);
    if (table.columns.empty()) closed = cells.size() > 1 && line.back() == delimiter;
    if (closed && line.back() == delimiter) cells.pop_back();
    if (table.columns.empty()) {
      for (const std::string_view cell : cells) {
        const std::size_t open = cell.find('[');
        std::string name(unquoted(trimmed(cell.substr(0, open))));
        Unit unit;
        if (open != std::string_view::npos) {
          try {
            unit = parse_unit(trimmed(cell.substr(open + 1, cell.find(']') - open - 1)));
          } catch (const InputError& error) {
            throw InputError(place, fmt::format("column '{}': {}", name, error.what()));
          }
        } else if (name.ends_with("_deg")) {
          unit = parse_unit("deg");
        }
        if (name.empty()) throw InputError(place, "a column of the header has no name");
        const auto known = table.names();
        if (std::find(known.begin(), known.end(), name) != known.end())
          throw InputError(place, fmt::format("column '{}' appears twice", name));
        recorded.push_back(unit);
        table.columns.push_back({std::move(name), unit.si(), {}});
      }
      continue;
    }
    if (cells.size() != table.columns.size())
      throw InputError(place, fmt::format("has {} cells, the header {}", cells.size(), table.columns.size()));
    table.lines.push_back(number);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      double value = kNaN;
      if (!cells[i].empty()) {
        const char* last = cells[i].data() + cells[i].size();
        const auto [stop, error] = std::from_chars(cells[i].data(), last, value);
        if (error != std::errc() || stop != last)
          throw InputError(place, fmt::format("column '{}': '{}' is not a number", table.columns[i].name, cells[i]));
      }
      table.columns[i].value.push_back(recorded[i].to_si(value));
    }
  }
  if (table.rows() == 0) throw InputError(table.source, "holds no rows of numbers under a header");
  return table;
}

Table read_table(const std::filesystem::path& path) { return parse_table(read_file(path), path.string()); }

}  // namespace veridyn::io
