#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "veridyn/report/document/document.hpp"
#include "veridyn/report/document/number_format.hpp"

/// What a reader finds in a report: blocks by kind, sections by title, cells by column.
namespace veridyn::report::test {

/// The blocks of one kind, in order.
template <typename Kind>
std::vector<Kind> blocks_of(const std::vector<Block>& blocks) {
  std::vector<Kind> found;
  for (const Block& block : blocks) {
    if (const auto* kind = std::get_if<Kind>(&block)) found.push_back(*kind);
  }
  return found;
}

/// The first table of this title.
inline Table table_of(const std::vector<Block>& blocks, std::string_view title) {
  for (const Table& table : blocks_of<Table>(blocks)) {
    if (table.title == title) return table;
  }
  throw std::runtime_error("no table " + std::string(title));
}

/// What a cell says under the column of this name and group.
inline std::string shown_in(const Table& table, const Row& row, std::string_view column, std::string_view group = {}) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].name == column && table.columns[i].group == group)
      return cell_text(row.cells.at(i), table.columns[i]);
  }
  throw std::runtime_error("no column " + std::string(column));
}

/// All that a row says, cell by cell.
inline std::vector<std::string> shown_row(const Table& table, std::size_t row) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    texts.push_back(cell_text(table.rows.at(row).cells.at(i), table.columns[i]));
  return texts;
}

/// The row whose first cell says this.
inline const Row& row_of(const Table& table, std::string_view first) {
  for (const Row& row : table.rows) {
    if (row.cells.front().text == first) return row;
  }
  throw std::runtime_error("no row " + std::string(first));
}

/// The texts of paragraphs and the items of lists.
inline std::vector<std::string> texts_of(const std::vector<Block>& blocks) {
  std::vector<std::string> texts;
  for (const Block& block : blocks) {
    if (const auto* paragraph = std::get_if<Paragraph>(&block)) texts.push_back(paragraph->text);
    if (const auto* list = std::get_if<List>(&block)) texts.insert(texts.end(), list->items.begin(), list->items.end());
  }
  return texts;
}

/// The names of a figure's panels or the names of a panel's lines.
inline std::vector<std::string> labels_of(const TimeSeries& figure) {
  std::vector<std::string> labels;
  for (const Panel& panel : figure.panels) labels.push_back(panel.label);
  return labels;
}
inline std::vector<std::string> lines_of(const Panel& panel) {
  std::vector<std::string> names;
  for (const Line& line : panel.lines) names.push_back(line.name);
  return names;
}

inline std::vector<std::string> titles_of(const Document& document) {
  std::vector<std::string> titles;
  for (const Section& section : document.sections) titles.push_back(section.title);
  return titles;
}

inline const Section& section_of(const Document& document, std::string_view title) {
  for (const Section& section : document.sections) {
    if (section.title == title) return section;
  }
  throw std::runtime_error("no section " + std::string(title));
}

/// The value of a fact at the top of the report; empty where there is none.
inline std::string fact_of(const std::vector<Fact>& facts, std::string_view name) {
  for (const Fact& fact : facts) {
    if (fact.name == name) return fact.value;
  }
  return {};
}

}  // namespace veridyn::report::test
