#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "veridyn/core/recording.hpp"
#include "veridyn/io/log/log.hpp"
#include "veridyn/io/tables/table_options.hpp"

namespace veridyn::io {

/// Reads numbers in columns.
///
/// Our own files: first row `name[unit]`, first column `time[s]`, an empty cell is a missing sample (NaN); lines
/// starting with '#' are comments, of which `# frame: frd` and `# key: value` ahead of the header are understood.
///
/// Other files: any header, also in the last comment line (`#` or `%`) ahead of rows of numbers; columns between
/// commas, semicolons, tabulators or, where there are none of these, blanks. Units stand in brackets or parentheses
/// after the name, as people write them (`unit_words.hpp`), or in a row of their own; where there is none the numbers
/// are left as they are, with unit "1". Columns of text are kept as text. A decimal comma is known by content and
/// noted. Names that appear again get their number, `V(2)`, noted too.
///
/// The stamps are in the column that the options name, else in the first of: time, t, t_s, time_s, seconds (s),
/// TimeMS, time_ms, millis (ms), TimeUS, time_us (us), timestamp and others (`time_column.cpp`), any `time...[unit]`,
/// the first column that holds dates or times of day; in GPS tables of old ArduPilot logs T, since their TimeMS is the
/// GPS clock; millis before a `time` that has a `date` next to it, which is a clock reading. Where neither options,
/// header nor name say the unit, `assume_time_unit` does, with a note.
///
/// Stamps may be dates (`date_stamp.hpp`): time is then counted from midnight of the first one's day, which is noted as
/// `date` in the information, and is UTC where they name their zone. So are stamps of a Unix clock (years 2000 to
/// 2100). Times of day go on after midnight. Where the clock restarts, one part is read and all are noted.
///
/// Files without a header: the options name the columns, with units in brackets. Where they do not and the first row
/// holds nothing but numbers and dates, the columns are called column_1, column_2, ... and that is noted.
///
/// Tolerated and noted: a last line that is cut, infinite numbers (become NaN), columns without a number. A delimiter
/// after the last cell of every row is taken for what it is.
/// @throws InputError with file:line and column for anything else: rows of another length, non-numeric cells,
/// time that goes backwards or is missing, names that appear twice in a file of ours, no rows, no time column.
[[nodiscard]] Log read_csv(std::string_view bytes, std::string source, const TableOptions& options = {});
/// Reads a file with `read_csv`.
[[nodiscard]] Log read_csv_file(const std::filesystem::path& path, const TableOptions& options = {});

/// Text of a recording as our own CSV: one row for each stamp that any channel has; cells of channels without a sample
/// there stay empty. Numbers read back to the same double. Events and parameters are not part of a CSV.
[[nodiscard]] std::string to_csv(const Recording& recording);

/// Writes `to_csv`; at every moment the old or the whole new file stands there.
/// @throws InputError when it cannot be written.
void write_csv(const Recording& recording, const std::filesystem::path& path);

}  // namespace veridyn::io
