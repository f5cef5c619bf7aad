#include "veridyn/io/tables/csv_cells.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "veridyn/core/index.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/io/log/log.hpp"

namespace veridyn::io::internal {

char guess_delimiter(std::string_view line) {
  char best = ',';
  std::ptrdiff_t most = 0;
  for (const char candidate : {'|', ',', ';', '\t'}) {
    const auto count = std::count(line.begin(), line.end(), candidate);
    if (count > most) {
      most = count;
      best = candidate;
    }
  }
  return most == 0 && trimmed(line).find(' ') != std::string_view::npos ? ' ' : best;
}

bool has_decimal_comma(std::string_view rows, char delimiter) {
  constexpr std::size_t kRows = 100;
  CellReader reader(rows, delimiter);
  bool found = false;
  while (!reader.at_end() && reader.lines() < kRows) {
    double value = 0.0;
    bool infinite = false;
    const char* const begin = reader.position();
    if (reader.number(value)) {
      if (std::find(begin, reader.position(), '.') != reader.position()) return false;
      continue;
    }
    const std::string cell = reader.text();
    found = found || (!unusual_number(cell, infinite) && unusual_number(cell, infinite, true));
  }
  return found;
}

std::optional<double> unusual_number(std::string_view cell, bool& infinite, bool decimal_comma) {
  if (cell.empty()) return kMissing;
  if (const std::size_t comma = cell.find(','); decimal_comma && comma != std::string_view::npos) {
    std::string with_point(cell);
    with_point[comma] = '.';
    // One comma between digits, and no point: 1.234,5 and 1,234,567 say something else.
    const bool plain = cell.find('.') == std::string_view::npos && with_point.find(',') == std::string::npos;
    return plain ? unusual_number(with_point, infinite) : std::nullopt;
  }
  double value = 0.0;
  const char* const end = cell.data() + cell.size();
  const auto [stop, error] = std::from_chars(cell.front() == '+' ? cell.data() + 1 : cell.data(), end, value);
  if (stop == end && error == std::errc{}) {
    infinite = infinite || std::isinf(value);
    return std::isinf(value) ? kMissing : value;
  }
  if (stop == end && error == std::errc::result_out_of_range) {
    const double limit = std::strtod(std::string(cell).c_str(), nullptr);
    infinite = infinite || std::isinf(limit);
    return std::isinf(limit) ? kMissing : limit;
  }
  for (const std::string_view word : {"NA", "N/A", "null", "NULL", "None", "-"}) {
    if (cell == word) return kMissing;
  }
  if (cell == "true" || cell == "True" || cell == "TRUE") return 1.0;
  if (cell == "false" || cell == "False" || cell == "FALSE") return 0.0;
  return std::nullopt;
}

std::string_view CellReader::line() {
  const auto* stop = static_cast<const char*>(std::memchr(at_, '\n', at(end_ - at_)));
  const char* const last = stop != nullptr ? stop : end_;
  const std::string_view text(at_, at(last - at_));
  at_ = stop != nullptr ? stop + 1 : end_;
  ++lines_;
  return trimmed(text);
}

bool CellReader::close_at_blank(const char* from) {
  while (from != end_ && (*from == ' ' || *from == '\t' || *from == '\r')) ++from;
  if (from != end_ && *from != '\n') {
    const char before = from == at_ ? '\0' : from[-1];
    if (before != ' ' && before != '\t' && before != '\r') return false;
    at_ = from;
    row_ended_ = false;
    newline_ = false;
    return true;
  }
  newline_ = from != end_;
  at_ = newline_ ? from + 1 : from;
  row_ended_ = true;
  ++lines_;
  return true;
}

std::string CellReader::text() {
  const char* from = at_;
  while (from != end_ && (*from == ' ' || (delimiter_ == ' ' && *from == '\t'))) ++from;
  std::string cell;
  if (from != end_ && *from == '"') {
    ++from;
    while (from != end_) {
      if (*from == '"') {
        if (from + 1 != end_ && from[1] == '"') {
          ++from;
        } else {
          break;
        }
      }
      if (*from == '\n') ++lines_;
      cell += *from++;
    }
    if (from != end_) ++from;
    while (from != end_ && !ends_cell(*from)) cell += *from++;
    close(from);
    return std::string(trimmed(cell));
  }
  while (from != end_ && !ends_cell(*from)) ++from;
  cell.assign(at_, from);
  close(from);
  return std::string(trimmed(cell));
}

}  // namespace veridyn::io::internal
