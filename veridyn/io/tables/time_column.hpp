#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/io/tables/csv_cells.hpp"
#include "veridyn/io/tables/csv_header.hpp"
#include "veridyn/io/tables/table_options.hpp"

namespace veridyn::io::internal {

/// A stamp written as text, in seconds: a date with its time, a time of day ("11:12:06.642"), or a duration with its
/// unit, as MATLAB writes them ("0.02 sec").
struct TextStamp {
  enum class Kind { kDate, kTimeOfDay, kDuration };
  Kind kind = Kind::kDate;
  std::int64_t day = 0;  ///< since 1970-01-01, of a date
  double second = 0.0;   ///< of the day, or the duration
  bool utc = false;      ///< a date with a time zone
};

/// Empty where the text is none of these. Does not throw.
[[nodiscard]] std::optional<TextStamp> parse_text_stamp(std::string_view text);

/// The unit that a name by which stamps are known says: "TimeMS" -> "ms". Empty for names that say none ("time"),
/// nothing for other names.
[[nodiscard]] std::optional<std::string_view> unit_of_time_name(std::string_view name);

/// A unit of stamps that was not given, and why.
struct AssumedUnit {
  std::string unit = "s";
  std::string note{};  ///< empty where nothing was assumed but the default
};

/// The unit of stamps of which only the numbers are known.
///
/// A Unix clock between 2000 and 2100 is known by the size of its numbers. Others: numbers with decimals are seconds;
/// whole ones are in the unit in which rows are 1/2000 s to 2 s apart (seconds first). A column `timestamp` holds
/// microseconds, as PX4 writes it, unless rows were then closer than 100 us.
/// @throws InputError at `place` where whole numbers fit two units: 1000 apart are 1 Hz in ms and 1 kHz in us
[[nodiscard]] AssumedUnit assume_time_unit(std::string_view name, std::span<const double> stamps,
                                           const std::string& place);

/// Where the stamps of a table are and what they are.
struct TimeChoice {
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::size_t column = kNone;  ///< none: stamps are made from a rate
  double scale = 1.0;          ///< to seconds
  bool texts = false;          ///< dates, times of day or durations
  std::string note{};          ///< what was assumed
};

/// The column among `names` that the options name, else the first of the names by which stamps are known.
/// @throws InputError where the options name one that is not there
[[nodiscard]] std::optional<std::size_t> find_time_column(std::span<const std::string> names,
                                                          const TableOptions& options, const std::string& place);

/// To seconds, from the options, else the header's unit, else the name, else by the stamps themselves.
/// @throws InputError where a unit is no time, and as `assume_time_unit`
[[nodiscard]] TimeChoice time_scale(const Header& header, const TableOptions& options, std::span<const double> stamps,
                                    const std::string& place);

/// Chooses as read_csv describes. @param rows the data, of which the first tell dates, and the unit where none is said
/// @throws InputError where there is no time column, the options name one that is not there, or its unit is no time
[[nodiscard]] TimeChoice choose_time(const std::vector<Header>& headers, const TableOptions& options,
                                     std::string_view rows, CellStyle style, const std::string& place);

}  // namespace veridyn::io::internal
