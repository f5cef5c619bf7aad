#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/io/tables/csv_cells.hpp"
#include "veridyn/io/tables/table_options.hpp"

namespace veridyn::io::internal {

/// Where a text has the names of its columns, their units and its rows.
struct TableLayout {
  /// A line ahead of the rows, and its number.
  struct Line {
    std::string_view text;
    std::size_t number = 0;
  };
  CellStyle style;
  std::vector<std::string> names;  ///< cells of the header; empty: there is none, and `columns` are as many
  std::vector<std::string> units;  ///< of a row of their own, in the words of `parse_unit`; empty: there is none
  std::size_t columns = 0;
  std::size_t header_line = 1;  ///< of the names, or the first of the rows
  std::size_t lines = 0;        ///< ahead of the rows
  std::string_view rows;
  std::vector<Line> comments;      ///< ahead of the rows, from their sign ('#' or '%') on
  std::vector<Line> descriptions;  ///< lines above the header that are no comments and belong to no table
  bool decimal_comma_found = false;
};

/// Finds what a table says of itself, by one description of all layouts that are known:
///
/// - lines of metadata of any form, which are not as long as the rows (Betaflight's explorer);
/// - comments, `#` or `%`, of which the last ones may be the names, their types and their units, in any order
/// (CarMaker);
/// - the names, where further rows of names (Garmin's G3X has a long and a short one), of types or of units may follow,
///   or a comment with units precede (Garmin's G1000);
/// - the rows, of which each holds a number or a date.
///
/// What `options` say (`skip_lines`, `delimiter`, `decimal`, `columns`) is not looked for.
/// @throws InputError for a text without a row, or one that is none
[[nodiscard]] TableLayout find_layout(std::string_view bytes, const TableOptions& options, const std::string& source);

}  // namespace veridyn::io::internal
