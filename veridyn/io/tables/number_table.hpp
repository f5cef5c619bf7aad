#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace veridyn::io {

/// A column of a plain table: numbers as they lie (NaN for an empty cell), or texts where a cell is not a number.
struct NumberColumn {
  std::string name;
  std::string unit = "1";  ///< as written; numbers are not converted
  std::vector<double> number = {};
  std::vector<std::string> text = {};  ///< of a column that is not of numbers; else empty

  [[nodiscard]] bool is_number() const { return text.empty(); }
};

/// Named columns of equal length, without a time base.
struct NumberTable {
  std::string source;
  std::vector<NumberColumn> columns = {};
  std::size_t rows = 0;

  /// @throws InputError naming the column and what there is
  [[nodiscard]] const NumberColumn& at(std::string_view name) const;
};

/// Reads a table whose first row names its columns, `name`, `name[unit]` or `name (unit)`: separated by commas,
/// semicolons, tabulators or blanks, whichever the header holds first in this order. Lines that start with '#' and
/// empty ones are passed over. `NaN`, `NA` and an empty cell are missing.
/// @throws InputError with file:line for a row of another length, a name that appears twice, a table without rows
[[nodiscard]] NumberTable read_number_table(std::string_view bytes, std::string source);
/// Reads a file with `read_number_table`.
[[nodiscard]] NumberTable read_number_table_file(const std::filesystem::path& path);

}  // namespace veridyn::io
