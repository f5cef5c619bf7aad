#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "veridyn/core/constants.hpp"

namespace veridyn::io::internal {

inline constexpr double kMissing = kNaN;

/// How cells are written.
struct CellStyle {
  char delimiter = ',';        ///< ' ': any number of blanks and tabulators
  bool decimal_comma = false;  ///< "0,5" is a half
};

/// Bar, comma, semicolon or tabulator, whichever the line holds most of; a blank where it holds none of them but
/// blanks.
[[nodiscard]] char guess_delimiter(std::string_view line);
/// The number that a cell stands for which is no plain one: empty, NA and the like are missing, true is 1; infinite
/// ones are missing and set `infinite`. Nothing for other text.
[[nodiscard]] std::optional<double> unusual_number(std::string_view cell, bool& infinite, bool decimal_comma = false);
/// Whether numbers among the first rows have a decimal comma, and none a point.
[[nodiscard]] bool has_decimal_comma(std::string_view rows, char delimiter);

/// A view of rows of which cells are taken one by one; quotes as in RFC 4180.
class CellReader {
 public:
  CellReader(std::string_view bytes, char delimiter)
      : at_(bytes.data()), end_(bytes.data() + bytes.size()), delimiter_(delimiter) {}
  CellReader(std::string_view bytes, CellStyle style) : CellReader(bytes, style.delimiter) {
    decimal_comma_ = style.decimal_comma;
  }

  [[nodiscard]] bool at_end() const { return at_ == end_; }
  [[nodiscard]] const char* position() const { return at_; }
  void move_to(const char* position) { at_ = position; }
  [[nodiscard]] std::size_t lines() const { return lines_; }
  [[nodiscard]] bool last_cell_of_row() const { return row_ended_; }
  [[nodiscard]] bool row_has_newline() const { return newline_; }

  /// The rest of a line, the line end left behind.
  std::string_view line();
  /// Tries to read the next cell as a number without looking at it twice. False leaves the position unchanged.
  bool number(double& value);
  /// The next cell as text without its quotes.
  std::string text();
  /// The next cell, where it is a number that `number` does not take, as `unusual_number`.
  std::optional<double> unusual(bool& infinite) { return unusual_number(text(), infinite, decimal_comma_); }

 private:
  bool close(const char* from);
  bool close_at_blank(const char* from);
  [[nodiscard]] bool ends_cell(char c) const {
    return c == delimiter_ || c == '\n' || (delimiter_ == ' ' && c == '\t');
  }

  const char* at_;
  const char* end_;
  char delimiter_;
  std::size_t lines_ = 0;
  bool decimal_comma_ = false;
  bool row_ended_ = false;
  bool newline_ = false;
};

// In the header: most of the time of reading a table is spent here.
inline bool CellReader::number(double& value) {
  const char* from = at_;
  while (from != end_ && *from == ' ') ++from;
  if (from != end_ && *from == '+') ++from;
  const auto [stop, error] = std::from_chars(from, end_, value);
  if (error != std::errc{}) return false;
  return close(stop);
}

inline bool CellReader::close(const char* from) {
  while (from != end_ && (*from == ' ' || *from == '\r')) ++from;
  if (from == end_) {
    at_ = from;
    row_ended_ = true;
    newline_ = false;
    ++lines_;
    return true;
  }
  if (*from == delimiter_) {
    at_ = from + 1;
    row_ended_ = false;
    newline_ = false;
    return true;
  }
  if (*from == '\n') {
    at_ = from + 1;
    row_ended_ = true;
    newline_ = true;
    ++lines_;
    return true;
  }
  return delimiter_ == ' ' && close_at_blank(from);
}

}  // namespace veridyn::io::internal
