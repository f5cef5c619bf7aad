#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/io/log/log.hpp"

namespace veridyn::io {

/// How to read a CSV file that is not written as this project writes it.
struct CsvOptions {
  std::string time_column{};  ///< name of the column with the stamps; empty: found by its name
  std::string time_unit{};    ///< unit of the stamps ("ms"); empty: from the header or the name
  /// Names of the columns, `name` or `name[unit]`, of a file that has no header; empty: the first row names them.
  std::vector<std::string> columns{};
  double rate = 0.0;      ///< [Hz] of the rows of a file that has no stamps: they are made; 0: there is a time column
  char delimiter = '\0';  ///< '\0': comma, semicolon or tabulator, whichever the header holds most of
};

/// Reads numbers in columns.
///
/// Our own files: first row `name[unit]`, first column `time[s]`, an empty cell is a missing sample (NaN); lines
/// starting with '#' are comments, of which `# frame: frd` and `# key: value` ahead of the header are understood.
///
/// Other files: any header. The stamps are in the column that the options name, else in the first of: time, t, t_s,
/// time_s, seconds (s), TimeMS, time_ms, millis (ms), TimeUS, time_us (us), timestamp (us, as ulog2csv of PX4 writes
/// it; seconds where the first stamp has a decimal point), any `time...[unit]`, the first column that holds dates; in
/// GPS tables of old ArduPilot logs T, since their TimeMS is the GPS clock; millis before a `time` that has a `date`
/// next to it, which is a clock reading. Columns of text are kept as text. A unit in brackets is used when it is a
/// unit; otherwise the numbers are left as they are, with unit "1".
///
/// Stamps may be dates (`date_stamp.hpp`): time is then counted from midnight of the first one's day, which is noted as
/// `date` in the information. So are stamps of a Unix clock (years 2000 to 2100).
///
/// Files without a header: the options name the columns, with units in brackets. Where they do not and the first row
/// holds nothing but numbers and dates, the columns are called column_1, column_2, ... and that is noted.
///
/// Tolerated and noted: a last line that is cut, infinite numbers (become NaN), columns without a number. A delimiter
/// after the last cell of every row is taken for what it is.
/// @throws InputError with file:line and column for anything else: rows of another length, non-numeric cells,
/// time that goes backwards or is missing, names that appear twice, no rows, no time column.
[[nodiscard]] Log read_csv(std::string_view bytes, std::string source, const CsvOptions& options = {});
/// Reads a file with `read_csv`.
[[nodiscard]] Log read_csv_file(const std::filesystem::path& path, const CsvOptions& options = {});

/// Text of a recording as our own CSV: one row for each stamp that any channel has; cells of channels without a sample
/// there stay empty. Numbers read back to the same double. Events and parameters are not part of a CSV.
[[nodiscard]] std::string to_csv(const Recording& recording);

/// Writes `to_csv`; at every moment the old or the whole new file stands there.
/// @throws InputError when it cannot be written.
void write_csv(const Recording& recording, const std::filesystem::path& path);

}  // namespace veridyn::io
