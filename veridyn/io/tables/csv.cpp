#include "veridyn/io/tables/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/io/log/mapped_file.hpp"
#include "veridyn/io/tables/clock_parts.hpp"
#include "veridyn/io/tables/csv_cells.hpp"
#include "veridyn/io/tables/csv_header.hpp"
#include "veridyn/io/tables/date_stamp.hpp"
#include "veridyn/io/tables/known_tables.hpp"
#include "veridyn/io/tables/plain_rows.hpp"
#include "veridyn/io/tables/table_layout.hpp"
#include "veridyn/io/tables/time_column.hpp"
#include "veridyn/io/tables/unit_words.hpp"

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

  /// Keeps the rows of a part.
  void keep(const internal::ClockPart& part) {
    const auto only = [&](auto& rows) {
      rows.erase(rows.begin() + signed_index(part.end), rows.end());
      rows.erase(rows.begin(), rows.begin() + signed_index(part.begin));
    };
    if (kind != Kind::kText) only(numbers);
    if (kind == Kind::kText) texts = texts.part(part.begin, part.end);
  }
};

/// View of the text of a table, parsed cell by cell.
class CsvParser {
 public:
  CsvParser(std::string_view bytes, std::string source, const TableOptions& options)
      : bytes_(bytes), options_(options) {
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

  void read_comment(const internal::TableLayout::Line& comment) {
    const std::string_view line = trimmed(comment.text.substr(1));
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) return;
    const std::string key = lower(trimmed(line.substr(0, colon)));
    if (key.find(',') != std::string::npos) return;  // cells, of which one has a colon
    const std::string value(trimmed(line.substr(colon + 1)));
    if (key == "frame") {
      if (value == "frd") log_.frame = Frame::kFrd;
      if (value == "flu") log_.frame = Frame::kFlu;
      if (value != "frd" && value != "flu") {
        throw InputError(place(comment.number), fmt::format("frame is '{}', expected frd or flu", shown(value)));
      }
    } else if (!key.empty()) {
      log_.information[internal::printable(key)] = internal::printable(value);
    }
  }

  void read_header() {
    internal::TableLayout layout = internal::find_layout(bytes_, options_, log_.source);
    for (const internal::TableLayout::Line& comment : layout.comments) read_comment(comment);
    describe(layout);
    style_ = layout.style;
    rows_ = layout.rows;
    line_ = layout.lines;
    header_line_ = layout.header_line;
    if (layout.decimal_comma_found)
      log_.damage.notes.emplace_back("numbers are read with a decimal comma; `decimal = \"point\"` in [data] does not");
    const bool named = !options_.columns.empty();
    std::vector<std::string> cells = named ? options_.columns : std::move(layout.names);
    if (cells.empty()) {
      for (std::size_t i = 0; i < layout.columns; ++i) cells.push_back(fmt::format("column_{}", i + 1));
      log_.damage.notes.push_back(
          fmt::format("there is no header: columns are called column_1 to column_{}", layout.columns));
    }
    our_own_ = !named && lower(cells.front()).rfind("time[", 0) == 0 && options_.time_column.empty();
    name_columns(cells, named);
    if (!our_own_ && !named) add_units(layout.units);
    time_ = internal::choose_time(headers_, options_, rows_, style_, place(header_line_));
    if (!time_.note.empty()) log_.damage.notes.push_back(time_.note);
    if (headers_.size() < 2 && time_.column != TimeChoice::kNone)
      throw InputError(place(header_line_), "there is no column but the time");
    columns_.resize(headers_.size());
  }

  static bool is_comment(char first) { return first == '#' || first == '%'; }

  /// Lines ahead of the table: "key: value", or a name and its value as two cells.
  void describe(const internal::TableLayout& layout) {
    if (layout.descriptions.empty()) return;
    log_.damage.notes.push_back(
        fmt::format("the names of the columns are in line {}; what stands above describes them", layout.header_line));
    for (const internal::TableLayout::Line& line : layout.descriptions) {
      const std::vector<std::string> cells = internal::cells_of(line.text, internal::guess_delimiter(line.text));
      if (cells.size() == 2 && !cells[0].empty() && !cells[0].ends_with(':')) {
        log_.information[internal::printable(cells[0])] = internal::printable(cells[1]);
      } else if (const std::size_t colon = line.text.find(':'); colon != std::string_view::npos && colon > 0) {
        log_.information[internal::printable(trimmed(line.text.substr(0, colon)))] =
            internal::printable(trimmed(line.text.substr(colon + 1)));
      }
    }
  }

  /// Units that stand elsewhere than after the names: in a row of their own, or with whoever writes such a table.
  void add_units(const std::vector<std::string>& units) {
    for (std::size_t i = 0; i < std::min(units.size(), headers_.size()); ++i)
      if (headers_[i].unit.empty() && !units[i].empty())
        headers_[i].unit = unit_of_column(units[i], headers_[i].name).value_or("");
    internal::add_known_units(headers_);
  }

  void name_columns(const std::vector<std::string>& cells, bool named) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (cells[i].empty()) {
        throw InputError(fmt::format("{}: column {}", place(header_line_), i + 1), "has no name");
      }
      // Units that a user wrote are not to be guessed at, as ours are not.
      headers_.push_back(internal::split_header(cells[i], our_own_ || named, place(header_line_)));
    }
    const std::vector<std::string> repeated = internal::number_repeated(headers_);
    if (repeated.empty()) return;
    if (our_own_ || named) {
      const std::string first = repeated.front().substr(0, repeated.front().rfind('('));
      throw InputError(place(header_line_), fmt::format("column '{}' appears twice", shown(first)));
    }
    log_.damage.notes.push_back(
        fmt::format("names of columns appear again, and are numbered: {}", fmt::join(repeated, ", ")));
  }

  /// Seconds since midnight of the first stamp's day, or of a duration; missing where there is none (a clock that waits
  /// for the satellites) and in the cell at which the file ends.
  double read_text_stamp(CellReader& reader) {
    const std::string cell = reader.text();
    if (cell.empty()) return kMissing;
    const auto stamp = internal::parse_text_stamp(cell);
    if (!stamp || (stamp_kind_ && stamp->kind != *stamp_kind_)) {
      if (reader.at_end() && !reader.row_has_newline()) return kMissing;
      throw InputError(fmt::format("{}: column '{}'", place(row_line_), headers_[time_.column].name),
                       fmt::format("'{}' is no date and time", shown(cell)));
    }
    stamp_kind_ = stamp->kind;
    if (stamp->kind == internal::TextStamp::Kind::kDate) {
      if (!first_day_) set_first_day(stamp->day);
      if (stamp->utc) log_.information["time zone"] = "UTC";
      return 86400.0 * static_cast<double>(stamp->day - *first_day_) + stamp->second;
    }
    if (stamp->kind == internal::TextStamp::Kind::kTimeOfDay) {
      // Half a day back is midnight.
      if (stamp->second < last_time_of_day_ - 43200.0) ++midnights_;
      last_time_of_day_ = stamp->second;
    }
    return 86400.0 * midnights_ + stamp->second;
  }

  void set_first_day(std::int64_t day) {
    first_day_ = day;
    log_.information["date"] = date_text(day);
  }

  void read_cell(CellReader& reader, std::size_t index) {
    Growing& column = columns_[index];
    if (time_.texts && index == time_.column) {
      column.kind = Growing::Kind::kNumber;
      column.numbers.push_back(read_text_stamp(reader));
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
    if (const auto number = internal::unusual_number(cell, infinite, style_.decimal_comma)) {
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

  /// All rows, where there are many and none is out of the ordinary.
  bool read_rows_in_parts() {
    if (time_.texts) return false;
    internal::PlainColumns columns{.count = headers_.size(), .time = {}, .time_scale = time_.scale};
    if (time_.column != TimeChoice::kNone) columns.time = time_.column;
    std::optional<std::vector<std::vector<double>>> read =
        internal::read_plain_rows(rows_, style_, columns, options_.threads);
    if (!read) return false;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      columns_[i].kind = Growing::Kind::kNumber;
      columns_[i].numbers = std::move((*read)[i]);
    }
    row_count_ = columns_.front().numbers.size();
    return true;
  }

  void read_rows() {
    if (read_rows_in_parts()) return;
    CellReader reader(rows_, style_);
    double last_time = -INFINITY;
    const std::size_t count = headers_.size();
    while (!reader.at_end()) {
      const char first = *reader.position();
      if (first == '\n' || first == '\r' || first == ' ' || first == '\t' || is_comment(first)) {
        const char* const begin = reader.position();
        const std::string_view line = reader.line();
        if (line.empty() || is_comment(line.front())) continue;
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
      if (time_.texts && std::isnan(columns_[time_.column].numbers.back())) {
        drop_row(count);
        ++without_time_;
        continue;
      }
      ++row_count_;
      if (time_.column == TimeChoice::kNone) continue;
      double& stamp = columns_[time_.column].numbers.back();
      stamp *= time_.scale;
      if (!(stamp >= last_time)) {
        const std::string where = fmt::format("{}: column '{}'", place(row_line_), headers_[time_.column].name);
        if (std::isnan(stamp)) throw InputError(where, "the time is missing");
        restarts_.push_back(row_count_ - 1);
        if (backwards_.empty()) {
          backwards_ = where;
          backwards_words_ = fmt::format("time goes backwards: {} s after {} s", stamp, last_time);
        }
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
    if (our_own_ || time_.texts || !(stamps.front() > kYear2000) || !(stamps.back() < kYear2100)) return stamps;
    set_first_day(static_cast<std::int64_t>(std::floor(stamps.front() / 86400.0)));
    for (double& stamp : stamps) stamp -= 86400.0 * static_cast<double>(*first_day_);
    return stamps;
  }

  /// Where the clock restarts, keeps one part of the rows.
  void keep_one_part() {
    if (row_count_ == 0 || time_.column == TimeChoice::kNone || restarts_.empty()) return;
    const std::vector<double>& stamps = columns_[time_.column].numbers;
    const std::vector<internal::ClockPart> parts = internal::clock_parts(restarts_, row_count_);
    if (parts.empty()) throw InputError(backwards_, backwards_words_);
    const std::size_t read = internal::choose_part(parts, stamps, options_.part, log_.source);
    log_.damage.notes.push_back(internal::parts_in_words(parts, stamps, read));
    log_.part = read + 1;
    log_.parts = parts.size();
    for (Growing& column : columns_) column.keep(parts[read]);
    row_count_ = parts[read].end - parts[read].begin;
  }

  /// Takes off the cells of a row that does not count.
  void drop_row(std::size_t cells) {
    for (std::size_t i = 0; i < cells; ++i) {
      if (columns_[i].kind == Growing::Kind::kText) {
        columns_[i].texts.resize(row_count_);
      } else {
        columns_[i].numbers.resize(row_count_);
      }
    }
  }

  void drop_cut_row(std::size_t cells) {
    drop_row(cells);
    ++log_.damage.records_lost;
    log_.damage.notes.push_back(
        fmt::format("line {} is cut ({} of {} cells) and was left out", row_line_, cells, headers_.size()));
  }

  Log finish() {
    keep_one_part();
    if (without_time_ > 0 && row_count_ > 0)
      log_.damage.notes.push_back(fmt::format("{} rows without a time were left out", without_time_));
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
  TableOptions options_;
  Log log_;
  internal::CellStyle style_;
  bool our_own_ = false;
  std::vector<Header> headers_;
  std::vector<Growing> columns_;
  TimeChoice time_;
  std::optional<std::int64_t> first_day_;
  std::optional<internal::TextStamp::Kind> stamp_kind_;
  double last_time_of_day_ = 0.0;
  int midnights_ = 0;
  std::vector<std::size_t> restarts_;  ///< rows whose stamp is before that of the row above
  std::string backwards_;              ///< where that is for the first time
  std::string backwards_words_;
  std::string_view rows_;
  std::size_t line_ = 0;  ///< lines before the rows
  std::size_t header_line_ = 1;
  std::size_t row_line_ = 0;
  std::size_t recounted_ = 0;
  std::size_t row_count_ = 0;
  std::size_t without_time_ = 0;
};

}  // namespace

Log read_csv(std::string_view bytes, std::string source, const TableOptions& options) {
  return CsvParser(bytes, std::move(source), options).run();
}

Log read_csv_file(const std::filesystem::path& path, const TableOptions& options) {
  const MappedFile file(path);
  return read_csv(file.bytes(), path.string(), options);
}

}  // namespace veridyn::io
