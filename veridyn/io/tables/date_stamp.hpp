#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace veridyn::io {

/// A date and a time of day: as written, where no time zone is given (Unix time is UTC), else of UTC.
struct DateStamp {
  std::int64_t day = 0;  ///< since 1970-01-01
  double second = 0.0;   ///< of that day [s]
  bool utc = false;      ///< the text said its zone
};

/// Reads `2016-09-12 11:12:06.642`. In the middle may be a blank, a T or an underscore; in the date dashes, slashes,
/// dots or underscores; in the time colons or underscores; then a fraction after a dot or a comma (or whole
/// milliseconds after an underscore, as in `2024_02_11_01_04_22_354`) or none. The year comes first and has four
/// digits; else the day does, as in `12.09.2016` and in MATLAB's `12-Sep-2016`. At the end a zone, `Z`, `UTC`,
/// `+02:00`, `-0530` or `+02`, is taken off. Empty when it is none of these or no such day or time exists. Does not
/// throw.
[[nodiscard]] std::optional<DateStamp> parse_date_stamp(std::string_view text);

/// Reads the time of day `11:12:06.642` as seconds since midnight; the fraction after a dot or a comma, or none. Does
/// not throw.
[[nodiscard]] std::optional<double> parse_time_of_day(std::string_view text);

/// "2024-02-11", of a day since 1970-01-01.
[[nodiscard]] std::string date_text(std::int64_t day);

}  // namespace veridyn::io
