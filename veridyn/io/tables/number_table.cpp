#include "veridyn/io/tables/number_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/nearest.hpp"

namespace veridyn::io {
namespace {

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n\"";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

char header_separator(std::string_view header) {
  for (const char c : {',', ';', '\t'})
    if (header.find(c) != std::string_view::npos) return c;
  return ' ';
}

/// Between blanks an empty cell cannot be.
std::vector<std::string_view> row_cells(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  std::size_t from = 0;
  while (from <= line.size()) {
    const std::size_t to = std::min(line.find(separator, from), line.size());
    const std::string_view cell = without_blanks(line.substr(from, to - from));
    if (separator != ' ' || !cell.empty()) cells.push_back(cell);
    from = to + 1;
  }
  return cells;
}

std::optional<double> cell_number(std::string_view cell) {
  if (cell.empty() || cell == "NA" || cell == "NaN" || cell == "nan") return kNaN;
  if (cell.starts_with('+')) cell.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return error == std::errc() && end == cell.data() + cell.size() ? std::optional(value) : std::nullopt;
}

NumberColumn named_column(std::string_view head) {
  NumberColumn column{.name = std::string(head)};
  for (const auto& [open, close] : {std::pair('[', ']'), std::pair('(', ')')}) {
    const std::size_t begin = head.find(open);
    if (begin == std::string_view::npos || begin == 0 || !head.ends_with(close)) continue;
    column.name = without_blanks(head.substr(0, begin));
    column.unit = without_blanks(head.substr(begin + 1, head.size() - begin - 2));
    if (column.unit.empty() || column.unit == "-") column.unit = "1";
    break;
  }
  return column;
}

}  // namespace

const NumberColumn& NumberTable::at(std::string_view name) const {
  const auto found = std::ranges::find(columns, name, &NumberColumn::name);
  if (found != columns.end()) return *found;
  std::vector<std::string> names;
  for (const NumberColumn& column : columns) names.push_back(column.name);
  throw InputError(source, fmt::format("has no column '{}'{}", name, suggestion(std::string(name), names)));
}

NumberTable read_number_table(std::string_view bytes, std::string source) {
  NumberTable table{.source = std::move(source)};
  std::vector<std::vector<std::string>> texts;
  std::vector<bool> is_text;
  char separator = ',';
  std::size_t line_number = 0, from = 0;
  while (from < bytes.size()) {
    const std::size_t to = std::min(bytes.find('\n', from), bytes.size());
    const std::string_view line = bytes.substr(from, to - from);
    from = to + 1;
    ++line_number;
    if (const std::string_view content = without_blanks(line); content.empty() || content.front() == '#') continue;
    const std::string place = fmt::format("{}:{}", table.source, line_number);
    if (table.columns.empty()) {
      separator = header_separator(line);
      for (const std::string_view head : row_cells(line, separator)) {
        NumberColumn column = named_column(head);
        if (column.name.empty()) throw InputError(place, "a column has no name");
        if (std::ranges::find(table.columns, column.name, &NumberColumn::name) != table.columns.end())
          throw InputError(place, fmt::format("the column '{}' appears twice", column.name));
        table.columns.push_back(std::move(column));
      }
      texts.resize(table.columns.size());
      is_text.resize(table.columns.size(), false);
      continue;
    }
    const std::vector<std::string_view> cells = row_cells(line, separator);
    if (cells.size() != table.columns.size())
      throw InputError(place, fmt::format("has {} cells where the header has {}", cells.size(), table.columns.size()));
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::optional<double> value = cell_number(cells[i]);
      is_text[i] = is_text[i] || !value;
      table.columns[i].number.push_back(value.value_or(kNaN));
      texts[i].emplace_back(cells[i]);
    }
    ++table.rows;
  }
  if (table.rows == 0) throw InputError(table.source, "holds no rows under a row of names");
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    if (is_text[i]) table.columns[i].text = std::move(texts[i]);
  return table;
}

NumberTable read_number_table_file(const std::filesystem::path& path) {
  return read_number_table(read_file(path), path.string());
}

}  // namespace veridyn::io
