#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace veridyn::io::internal {

/// The name of a column and its unit.
struct Header {
  std::string name;
  std::string unit;  ///< empty: none given
};

/// `name[unit]` in its parts; in files by others also `name (unit)`, `name, unit` and `name/unit`, with units as people
/// write them. There "control[3]" is an element, and brackets that hold no unit are part of the name; in ours
/// (`our_own`) the last brackets always hold a unit. "pitch,__deg" (X-Plane) keeps its name and has the unit.
/// @throws InputError for an unknown unit in a file of ours
[[nodiscard]] Header split_header(const std::string& cell, bool our_own, const std::string& place);

/// The cells of a header between blanks, where a unit in brackets belongs to the name before it: "Time (s) p (deg/s)",
/// "V/(m/s)".
[[nodiscard]] std::vector<std::string> blank_separated(std::string_view line);

/// The cells of a line.
[[nodiscard]] std::vector<std::string> cells_of(std::string_view line, char delimiter);

/// Whether cells are data: numbers, dates and times, at least one of them not empty.
[[nodiscard]] bool holds_only_data(const std::vector<std::string>& cells, bool decimal_comma);

/// The units of a row that holds nothing else (below the names, as loggers of cars write them), with "" for none;
/// empty: it is no such row.
[[nodiscard]] std::vector<std::string> row_of_units(const std::vector<std::string>& cells);

/// The same of a row that next to units holds words for what has none ("enum", "hh:mm:ss", "bool"): half of its cells
/// are units, two at least.
[[nodiscard]] std::vector<std::string> row_of_units_and_words(const std::vector<std::string>& cells);

/// Names that appear again get their number, `V(2)`; which did is returned.
std::vector<std::string> number_repeated(std::vector<Header>& headers);

}  // namespace veridyn::io::internal
