#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace veridyn::io {

/// What the user says of a table: a CSV file, a folder of them, NumPy arrays, arrays of a MATLAB file. What is left out
/// is found by content, and what was assumed is noted.
struct TableOptions {
  std::string time_column{};  ///< name of the column with the stamps; empty: found by its name
  std::string time_unit{};    ///< unit of the stamps ("ms"); empty: from header or name, else by how far rows are apart
  /// Names of the columns, `name` or `name[unit]`, of a table that has none; empty: the first row names them.
  std::vector<std::string> columns{};
  std::string variable{};      ///< of a MATLAB file: the matrix whose columns are the channels; empty: found by content
  std::size_t skip_lines = 0;  ///< of a text, before anything of it is looked at
  double rate = 0.0;      ///< [Hz] of the rows of a table that has no stamps: they are made; 0: there is a time column
  char delimiter = '\0';  ///< ' ' for blanks and tabulators; '\0': comma, semicolon or tabulator, else blanks
  char decimal = '\0';    ///< '.' or ','; '\0': a comma where cells hold one and it does not separate them
  /// Which part of a file of several, from 1: of a table whose clock restarts (0: the longest), of any log with pauses
  /// (0: all).
  std::size_t part = 0;
  int threads = 1;  ///< that read a large CSV file; 0: as many as the machine has. What is read does not depend on it
};

}  // namespace veridyn::io
