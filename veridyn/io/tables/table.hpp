#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/units.hpp"

namespace veridyn::io {

/// One column of a table, in SI.
struct TableColumn {
  std::string name;
  Unit unit;                  ///< SI
  std::vector<double> value;  ///< NaN where the cell is empty
};

/// A table of numbers without a time: points of a wind tunnel, a calibration, a polar.
struct Table {
  std::string source;
  std::vector<TableColumn> columns;
  std::vector<std::size_t> lines{};  ///< of the file, of each row

  [[nodiscard]] std::size_t rows() const { return columns.empty() ? 0 : columns.front().value.size(); }
  [[nodiscard]] std::vector<std::string> names() const;
  /// The column. @throws InputError naming it and the nearest one.
  [[nodiscard]] const TableColumn& at(std::string_view name) const;
};

/// Reads columns under a header `name[unit],...` (also `alpha_deg`, `beta_deg` for degrees), separated by comma,
/// semicolon or tabulator, whichever the header holds most of; lines that start with '#' are comments. A delimiter
/// after the last cell of the header is taken for what it is.
/// @throws InputError with file:line for rows of another length, non-numeric cells, unknown units, names that
/// appear twice, or no rows.
[[nodiscard]] Table read_table(const std::filesystem::path& path);
/// The same from text.
[[nodiscard]] Table parse_table(std::string_view text, std::string source);

}  // namespace veridyn::io
