#include "veridyn/io/tables/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/io/log/mapped_file.hpp"
#include "veridyn/io/tables/csv_cells.hpp"
#include "veridyn/io/tables/csv_header.hpp"
#include "veridyn/io/tables/date_stamp.hpp"

namespace veridyn::io {
namespace {

using internal::CellReader;
using internal::Header;
using internal::kMissing;
using internal::TimeChoice;

/// A column while it is being read; text once its first cell that is not empty is no number.
struct Growing {
  enum class Kind { kOpen, kNumber, kText };
  Kind kind = Kind::kOpen;
  std::vector<double> numbers;
  TextColumn texts;
  std::size_t infinite = 0;
};

/// View of the text of a table, parsed cell by cell.
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
    line = trimmed(line.substr(1));
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) return;
    const std::string key = lower(trimmed(line.substr(0, colon)));
    const std::string value(trimmed(line.substr(colon + 1)));
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
      line = trimmed(rest.substr(0, stop));
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
    delimiter_ = options_.delimiter != '\0' ? options_.delimiter : internal::guess_delimiter(line);
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
      headers_.push_back(internal::split_header(internal::printable(cells[i]), our_own || named, place(header_line_)));
      if (!taken.insert(headers_.back().name).second) {
        throw InputError(place(header_line_), fmt::format("column '{}' appears twice", shown(headers_.back().name)));
      }
    }
    our_own_ = our_own;
    if (headless) {
      rows_ = rest;
    } else {
      line_ += reader.lines();
      rows_ = std::string_view(reader.position(), at(bytes_.data() + bytes_.size() - reader.position()));
    }
    time_ =
        internal::choose_time(headers_, options_, rows_.substr(0, rows_.find('\n')), delimiter_, place(header_line_));
    if (headers_.size() < 2 && time_.column != TimeChoice::kNone)
      throw InputError(place(header_line_), "there is no column but the time");
    columns_.resize(headers_.size());
  }

  /// Whether a first row is no header: numbers and dates, at least one of them no empty cell.
  static bool holds_only_data(const std::vector<std::string>& cells) {
    bool any = false;
    for (const std::string& cell : cells) {
      bool infinite = false;
      const bool data = parse_date_stamp(cell).has_value() || internal::unusual_number(cell, infinite).has_value();
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
    if (const auto number = internal::unusual_number(cell, infinite)) {
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
