#include "veridyn/io/tables/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <optional>
#include <set>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/io/tables/date_stamp.hpp"
#include "veridyn/io/log/mapped_file.hpp"

namespace veridyn::io {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

std::string_view trim(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return result;
}

// A cell for a message: at most 40 characters.
std::string shown(std::string_view cell) {
  std::string text = internal::printable(cell.substr(0, 40));
  std::replace(text.begin(), text.end(), '\n', ' ');
  return cell.size() > 40 ? text + "..." : text;
}

/// Takes cells one by one from a row; quotes as in RFC 4180.
class CellReader {
 public:
  CellReader(std::string_view bytes, char delimiter)
      : at_(bytes.data()), end_(bytes.data() + bytes.size()), delimiter_(delimiter) {}

  [[nodiscard]] bool at_end() const { return at_ == end_; }
  [[nodiscard]] const char* position() const { return at_; }
  void move_to(const char* position) { at_ = position; }
  [[nodiscard]] std::size_t lines() const { return lines_; }
  [[nodiscard]] bool last_cell_of_row() const { return row_ended_; }
  [[nodiscard]] bool row_has_newline() const { return newline_; }

  /// The rest of a line, the line end left behind.
  std::string_view line() {
    const auto* stop = static_cast<const char*>(std::memchr(at_, '\n', static_cast<std::size_t>(end_ - at_)));
    const char* const last = stop != nullptr ? stop : end_;
    const std::string_view text(at_, static_cast<std::size_t>(last - at_));
    at_ = stop != nullptr ? stop + 1 : end_;
    ++lines_;
    return trim(text);
  }

  /// Tries to read the next cell as a number without looking at it twice. False leaves the position unchanged.
  bool number(double& value) {
    const char* from = at_;
    while (from != end_ && *from == ' ') ++from;
    if (from != end_ && *from == '+') ++from;
    const auto [stop, error] = std::from_chars(from, end_, value);
    if (error != std::errc{}) return false;
    return close(stop);
  }

  /// The next cell as text without its quotes.
  std::string text() {
    const char* from = at_;
    while (from != end_ && *from == ' ') ++from;
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
      while (from != end_ && *from != delimiter_ && *from != '\n') cell += *from++;
      close(from);
      return std::string(trim(cell));
    }
    while (from != end_ && *from != delimiter_ && *from != '\n') ++from;
    cell.assign(at_, from);
    close(from);
    return std::string(trim(cell));
  }

 private:
  bool close(const char* from) {
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
    return false;
  }

  const char* at_;
  const char* end_;
  char delimiter_;
  std::size_t lines_ = 0;
  bool row_ended_ = false;
  bool newline_ = false;
};

struct Header {
  std::string name;
  std::string unit;  ///< empty: none given
};

Header split_header(const std::string& cell, bool our_own, const std::string& place) {
  Header header{cell, ""};
  if (cell.empty() || cell.back() != ']') return header;
  const std::size_t open = cell.rfind('[');
  if (open == std::string::npos || open == 0) return header;
  const std::string unit = cell.substr(open + 1, cell.size() - open - 2);
  const std::string name(trim(std::string_view(cell).substr(0, open)));
  // In files by others "control[3]" is an element, in ours the last brackets always hold a unit.
  const bool element = !unit.empty() && unit.find_first_not_of("0123456789") == std::string::npos;
  if (!our_own && element) return header;
  try {
    (void)parse_unit(unit);
  } catch (const InputError& error) {
    if (our_own) throw InputError(fmt::format("{}: column '{}'", place, name), error.what());
    return header;
  }
  return {name, unit.empty() ? "1" : unit};
}

struct TimeChoice {
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::size_t column = kNone;  ///< none: stamps are made from a rate
  double scale = 1.0;
  bool dates = false;
};

// Names under which stamps are known, with their unit. '?': microseconds, or seconds with a decimal point.
struct TimeName {
  std::string_view name;
  std::string_view unit;
};
constexpr TimeName kTimeNames[] = {{"time", "s"},          {"t", "s"},
                                   {"t_s", "s"},           {"time_s", "s"},
                                   {"seconds", "s"},       {"sec", "s"},
                                   {"time_sec", "s"},      {"timems", "ms"},
                                   {"time_ms", "ms"},      {"t_ms", "ms"},
                                   {"timeus", "us"},       {"time_us", "us"},
                                   {"t_us", "us"},         {"timestamp_us", "us"},
                                   {"timestamp_ms", "ms"}, {"timestamp_s", "s"},
                                   {"timestamp_ns", "ns"}, {"time_ns", "ns"},
                                   {"millis", "ms"},       {"timestamp", "?"}};

TimeChoice choose_time(const std::vector<Header>& headers, const CsvOptions& options, std::string_view first_row,
                       char delimiter, const std::string& place) {
  if (options.rate > 0.0) return {};
  std::vector<std::string> first_cells;
  CellReader first(first_row, delimiter);
  while (first_cells.size() < headers.size() && !first.at_end()) first_cells.push_back(first.text());
  first_cells.resize(headers.size());
  std::vector<std::string> names;
  for (const Header& header : headers) names.push_back(header.name);
  const auto column_of = [&](std::string_view wanted) -> std::optional<std::size_t> {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (lower(names[i]) == wanted) return i;
    }
    return std::nullopt;
  };
  std::optional<std::size_t> column;
  std::string unit;
  if (!options.time_column.empty()) {
    const auto found = std::find(names.begin(), names.end(), options.time_column);
    if (found == names.end()) {
      throw InputError(place, fmt::format("no column '{}' for the time{}", options.time_column,
                                          suggestion(options.time_column, names)));
    }
    column = static_cast<std::size_t>(found - names.begin());
  } else if (column_of("timems") && column_of("week") && column_of("t")) {
    column = column_of("t");
    unit = "ms";
  } else if (column_of("date") && column_of("time") && column_of("millis")) {
    column = column_of("millis");
  }
  for (const TimeName& known : kTimeNames) {
    if (column && lower(names[*column]) != known.name) continue;
    const auto found = column_of(known.name);
    if (!found) continue;
    column = column ? column : found;
    if (unit.empty()) unit = known.unit;
    break;
  }
  if (!column) {
    const Unit second = parse_unit("s");
    for (std::size_t i = 0; i < headers.size() && !column; ++i) {
      if (headers[i].unit.empty() || lower(headers[i].name).rfind("time", 0) != 0) continue;
      if (parse_unit(headers[i].unit).same_dimension(second)) column = i;
    }
  }
  for (std::size_t i = 0; i < headers.size() && !column; ++i) {
    if (parse_date_stamp(first_cells[i])) column = i;
  }
  if (!column) {
    throw InputError(place, fmt::format("no time column found among {}; name it (time_column), or call it 'time[s]'",
                                        shown(fmt::format("{}", fmt::join(names, ", ")))));
  }
  if (parse_date_stamp(first_cells[*column])) return {*column, 1.0, true};
  if (!headers[*column].unit.empty()) unit = headers[*column].unit;
  if (!options.time_unit.empty()) unit = options.time_unit;
  if (unit == "?") unit = first_cells[*column].find('.') != std::string::npos ? "s" : "us";
  if (unit.empty()) unit = "s";
  try {
    return {*column, parse_unit_like(unit, parse_unit("s")).scale};
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: column '{}'", place, names[*column]), error.what());
  }
}

char guess_delimiter(std::string_view line) {
  char best = ',';
  std::ptrdiff_t most = 0;
  for (const char candidate : {',', ';', '\t'}) {
    const auto count = std::count(line.begin(), line.end(), candidate);
    if (count > most) {
      most = count;
      best = candidate;
    }
  }
  return best;
}

/// A cell that is no plain number but stands for one.
std::optional<double> unusual_number(std::string_view cell, bool& infinite) {
  if (cell.empty()) return kMissing;
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

/// A column while it is being read; text once its first cell that is not empty is no number.
struct Growing {
  enum class Kind { kOpen, kNumber, kText };
  Kind kind = Kind::kOpen;
  std::vector<double> numbers;
  TextColumn texts;
  std::size_t infinite = 0;
};

class CsvParser {
 public:
  CsvParser(std::string_view bytes, std::string source, const CsvOptions& options) : bytes_(bytes), options_(options) {
    log_.source = std::move(source);
    log_.format = "CSV";
  }

  Log run() {
    if (bytes_.substr(0, 3) == "\xEF\xBB\xBF") bytes_.remove_prefix(3);
    if (bytes_.empty()) throw InputError(log_.source, "the file is empty");
    read_header();
    read_rows();
    return finish();
  }

 private:
  [[nodiscard]] std::string place(std::size_t line) const { return fmt::format("{}:{}", log_.source, line); }

  void read_comment(std::string_view line) {
    line = trim(line.substr(1));
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) return;
    const std::string key = lower(trim(line.substr(0, colon)));
    const std::string value(trim(line.substr(colon + 1)));
    if (key == "frame") {
      if (value == "frd") log_.frame = Frame::kFrd;
      if (value == "flu") log_.frame = Frame::kFlu;
      if (value != "frd" && value != "flu") {
        throw InputError(place(line_ + 1), fmt::format("frame is '{}', expected frd or flu", shown(value)));
      }
    } else if (!key.empty()) {
      log_.information[internal::printable(key)] = internal::printable(value);
    }
  }

  void read_header() {
    std::string_view rest = bytes_;
    std::string_view line;
    while (line.empty()) {
      if (rest.empty()) throw InputError(log_.source, "no header: the file has only blank lines and comments");
      const std::size_t stop = std::min(rest.find('\n'), rest.size());
      line = trim(rest.substr(0, stop));
      if (line.empty() || line.front() == '#') {
        if (!line.empty()) read_comment(line);
        line = {};
        rest.remove_prefix(std::min(stop + 1, rest.size()));
        ++line_;
      }
    }
    for (const char c : line) {
      const auto byte = static_cast<unsigned char>(c);
      if (byte < 0x20 && c != '\t') throw InputError(place(line_ + 1), "not a CSV file: the first row is not text");
    }
    delimiter_ = options_.delimiter != '\0' ? options_.delimiter : guess_delimiter(line);
    CellReader reader(rest, delimiter_);
    std::vector<std::string> cells;
    do {
      cells.push_back(reader.text());
    } while (!reader.last_cell_of_row() && !reader.at_end());
    if (cells.size() > 1 && cells.back().empty()) cells.pop_back();
    header_line_ = line_ + 1;
    const bool named = !options_.columns.empty();
    const bool headless = named || holds_only_data(cells);
    if (named) {
      cells = options_.columns;
    } else if (headless) {
      for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = fmt::format("column_{}", i + 1);
      log_.damage.notes.push_back(
          fmt::format("there is no header: columns are called column_1 to column_{}", cells.size()));
    }
    const bool our_own = !named && lower(cells.front()).rfind("time[", 0) == 0 && options_.time_column.empty();
    std::set<std::string> taken;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (cells[i].empty()) {
        throw InputError(fmt::format("{}: column {}", place(header_line_), i + 1), "has no name");
      }
      // Units that a user wrote are not to be guessed at, as ours are not.
      headers_.push_back(split_header(internal::printable(cells[i]), our_own || named, place(header_line_)));
      if (!taken.insert(headers_.back().name).second) {
        throw InputError(place(header_line_), fmt::format("column '{}' appears twice", shown(headers_.back().name)));
      }
    }
    our_own_ = our_own;
    if (headless) {
      rows_ = rest;
    } else {
      line_ += reader.lines();
      rows_ = std::string_view(reader.position(),
                               static_cast<std::size_t>(bytes_.data() + bytes_.size() - reader.position()));
    }
    time_ = choose_time(headers_, options_, rows_.substr(0, rows_.find('\n')), delimiter_, place(header_line_));
    if (headers_.size() < 2 && time_.column != TimeChoice::kNone)
      throw InputError(place(header_line_), "there is no column beside the time");
    columns_.resize(headers_.size());
  }

  /// Whether a first row is no header: numbers and dates, at least one of them no empty cell.
  static bool holds_only_data(const std::vector<std::string>& cells) {
    bool any = false;
    for (const std::string& cell : cells) {
      bool infinite = false;
      const bool data = parse_date_stamp(cell).has_value() || unusual_number(cell, infinite).has_value();
      if (!data) return false;
      any = any || !cell.empty();
    }
    return any;
  }

  /// Seconds since midnight of the first stamp's day; missing in the cell at which the file ends.
  double read_date(CellReader& reader) {
    const std::string cell = reader.text();
    if (const auto stamp = parse_date_stamp(cell)) {
      if (!first_day_) set_first_day(stamp->day);
      return 86400.0 * static_cast<double>(stamp->day - *first_day_) + stamp->second;
    }
    if (reader.at_end() && !reader.row_has_newline()) return kMissing;
    throw InputError(fmt::format("{}: column '{}'", place(row_line_), headers_[time_.column].name),
                     fmt::format("'{}' is no date and time", shown(cell)));
  }

  void set_first_day(std::int64_t day) {
    first_day_ = day;
    log_.information["date"] = date_text(day);
  }

  void read_cell(CellReader& reader, std::size_t index) {
    Growing& column = columns_[index];
    if (time_.dates && index == time_.column) {
      column.kind = Growing::Kind::kNumber;
      column.numbers.push_back(read_date(reader));
      return;
    }
    double value = 0.0;
    if (column.kind != Growing::Kind::kText) {
      if (reader.number(value)) {
        if (std::isinf(value)) {
          ++column.infinite;
          value = kMissing;
        }
        column.kind = Growing::Kind::kNumber;
        column.numbers.push_back(value);
        return;
      }
    }
    const std::string cell = reader.text();
    if (column.kind == Growing::Kind::kText) {
      column.texts.push_back(cell);
      return;
    }
    bool infinite = false;
    if (const auto number = unusual_number(cell, infinite)) {
      column.infinite += infinite ? 1U : 0U;
      if (!cell.empty() && column.kind == Growing::Kind::kOpen) column.kind = Growing::Kind::kNumber;
      column.numbers.push_back(*number);
      return;
    }
    if (column.kind == Growing::Kind::kNumber || our_own_ || index == time_.column) {
      throw InputError(fmt::format("{}: column '{}'", place(row_line_), headers_[index].name),
                       fmt::format("'{}' is not a number", shown(cell)));
    }
    column.kind = Growing::Kind::kText;
    for (std::size_t i = 0; i < column.numbers.size(); ++i) column.texts.push_back("");
    column.numbers = {};
    column.texts.push_back(cell);
  }

  void read_rows() {
    CellReader reader(rows_, delimiter_);
    double last_time = -INFINITY;
    const std::size_t count = headers_.size();
    while (!reader.at_end()) {
      const char first = *reader.position();
      if (first == '\n' || first == '\r' || first == '#' || first == ' ') {
        const char* const begin = reader.position();
        const std::string_view line = reader.line();
        if (line.empty() || line.front() == '#') continue;
        reader.move_to(begin);  // a row that starts with a blank; its line was counted, so is taken back below
        ++recounted_;
      }
      row_line_ = line_ + reader.lines() + 1 - recounted_;
      std::size_t cells = 0;
      bool extra = false;
      while (true) {
        if (cells == count) {
          // One empty cell more than the header is a delimiter at the end of the row.
          if (!reader.text().empty() || !reader.last_cell_of_row()) extra = true;
          if (extra) break;
        } else {
          read_cell(reader, cells);
          ++cells;
        }
        if (reader.last_cell_of_row()) break;
        if (reader.at_end()) break;
      }
      if (extra || cells < count) {
        if (!extra && reader.at_end() && !reader.row_has_newline()) {
          drop_cut_row(cells);
          break;
        }
        const char* const names = options_.columns.empty() ? "the header" : "`columns`";
        throw InputError(place(row_line_), extra ? fmt::format("more cells than the {} of {}", count, names)
                                                 : fmt::format("{} cells, {} has {}", cells, names, count));
      }
      ++row_count_;
      if (time_.column == TimeChoice::kNone) continue;
      double& stamp = columns_[time_.column].numbers.back();
      stamp *= time_.scale;
      if (!(stamp >= last_time)) {
        const std::string where = fmt::format("{}: column '{}'", place(row_line_), headers_[time_.column].name);
        if (std::isnan(stamp)) throw InputError(where, "the time is missing");
        throw InputError(where, fmt::format("time goes backwards: {} s after {} s", stamp, last_time));
      }
      last_time = stamp;
    }
  }

  /// The stamps, in seconds; those of a Unix clock from midnight of the first day, where a double resolves them well.
  std::vector<double> take_stamps() {
    if (time_.column == TimeChoice::kNone) {
      std::vector<double> made(row_count_);
      for (std::size_t i = 0; i < row_count_; ++i) made[i] = static_cast<double>(i) / options_.rate;
      return made;
    }
    std::vector<double> stamps = std::move(columns_[time_.column].numbers);
    constexpr double kYear2000 = 946684800.0;
    constexpr double kYear2100 = 4102444800.0;
    if (our_own_ || time_.dates || !(stamps.front() > kYear2000) || !(stamps.back() < kYear2100)) return stamps;
    set_first_day(static_cast<std::int64_t>(std::floor(stamps.front() / 86400.0)));
    for (double& stamp : stamps) stamp -= 86400.0 * static_cast<double>(*first_day_);
    return stamps;
  }

  void drop_cut_row(std::size_t cells) {
    for (std::size_t i = 0; i < cells; ++i) {
      if (columns_[i].kind == Growing::Kind::kText) {
        columns_[i].texts.resize(row_count_);
      } else {
        columns_[i].numbers.resize(row_count_);
      }
    }
    ++log_.damage.records_lost;
    log_.damage.notes.push_back(
        fmt::format("line {} is cut ({} of {} cells) and was left out", row_line_, cells, headers_.size()));
  }

  Log finish() {
    if (row_count_ == 0) throw InputError(log_.source, "there is a header but not one row of data");
    LogTopic topic;
    std::vector<std::string> empty;
    for (std::size_t i = 0; i < headers_.size(); ++i) {
      if (i == time_.column) continue;
      LogField field;
      field.name = headers_[i].name;
      field.unit = headers_[i].unit.empty() ? "1" : headers_[i].unit;
      Growing& column = columns_[i];
      if (column.infinite > 0) {
        log_.damage.notes.push_back(
            fmt::format("column '{}': {} infinite numbers are taken as missing", field.name, column.infinite));
      }
      if (column.kind == Growing::Kind::kText) {
        field.values = Column(std::move(column.texts));
      } else {
        if (std::all_of(column.numbers.begin(), column.numbers.end(), [](double x) { return std::isnan(x); })) {
          empty.push_back(field.name);
        }
        field.values = Column(std::move(column.numbers));
      }
      topic.fields.push_back(std::move(field));
    }
    if (!empty.empty()) {
      log_.damage.notes.push_back(fmt::format("columns without one number: {}", fmt::join(empty, ", ")));
    }
    std::vector<double> stamps = take_stamps();
    for (std::size_t i = 1; i < stamps.size(); ++i) topic.doubled += stamps[i] == stamps[i - 1] ? 1U : 0U;
    topic.time = make_time_base(std::move(stamps));
    log_.topics.push_back(std::move(topic));
    internal::finish(log_);
    return std::move(log_);
  }

  std::string_view bytes_;
  CsvOptions options_;
  Log log_;
  char delimiter_ = ',';
  bool our_own_ = false;
  std::vector<Header> headers_;
  std::vector<Growing> columns_;
  TimeChoice time_;
  std::optional<std::int64_t> first_day_;
  std::string_view rows_;
  std::size_t line_ = 0;  ///< lines before the rows
  std::size_t header_line_ = 1;
  std::size_t row_line_ = 0;
  std::size_t recounted_ = 0;
  std::size_t row_count_ = 0;
};

}  // namespace

Log read_csv(std::string_view bytes, std::string source, const CsvOptions& options) {
  return CsvParser(bytes, std::move(source), options).run();
}

Log read_csv_file(const std::filesystem::path& path, const CsvOptions& options) {
  const MappedFile file(path);
  return read_csv(file.bytes(), path.string(), options);
}

}  // namespace veridyn::io
