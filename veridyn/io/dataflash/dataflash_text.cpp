#include "veridyn/io/dataflash/dataflash_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <variant>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/io/dataflash/dataflash_schema.hpp"
#include "veridyn/io/log/clock_restarts.hpp"
#include "veridyn/io/log/time_stamps.hpp"

namespace veridyn::io {
namespace {

void split_cells(std::string_view line, std::vector<std::string_view>& cells) {
  cells.clear();
  while (true) {
    const std::size_t comma = line.find(',');
    cells.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return;
    line.remove_prefix(comma + 1);
  }
}

std::optional<double> number_of(std::string_view cell) {
  double value = 0.0;
  const auto [stop, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc{} || stop != cell.data() + cell.size()) return std::nullopt;
  return value;
}

bool is_text_type(char type) { return type == 'n' || type == 'N' || type == 'Z'; }

/// A message type while its lines are read.
struct TextTable {
  DataFlashFormat format;
  std::vector<DataFlashColumn> columns;
  std::optional<DataFlashTime> time;
  std::vector<std::vector<double>> numbers;  ///< by column; empty for texts
  std::vector<TextColumn> texts;             ///< by column; empty for numbers
  std::vector<double> stamps;                ///< [s]
  std::vector<std::uint64_t> places;         ///< which rows of the log they are
};

/// View of the text of a log, read line by line into tables.
class TextReader {
 public:
  TextReader(std::string_view bytes, Log& log) : data_(bytes), log_(log) {}

  void run() {
    std::vector<std::string_view> cells;
    std::string_view rest = data_;
    while (!rest.empty()) {
      const std::size_t stop = rest.find('\n');
      const std::string_view line = trimmed(rest.substr(0, stop));
      const bool last = stop == std::string_view::npos;
      rest.remove_prefix(last ? rest.size() : stop + 1);
      if (line.empty()) continue;
      split_cells(line, cells);
      if (cells[0] == "FMT") {
        if (!define(cells)) count_lost(line, last);
        continue;
      }
      if (tables_.empty()) continue;  // a title ahead of the formats
      const auto found = index_.find(cells[0]);
      if (found == index_.end() || !take(tables_[found->second], cells)) count_lost(line, last);
    }
    restarts_.finish();
    for (TextTable& table : tables_) restarts_.shift(table.stamps, table.places);
    restarts_.report_to(log_);
  }

  std::vector<TextTable>& tables() { return tables_; }

 private:
  void count_lost(std::string_view line, bool last) {
    log_.damage.bytes_lost += line.size();
    ++log_.damage.records_lost;
    if (last) log_.damage.notes.emplace_back("the log ends in the middle of a line");
  }

  // FMT, type, length, name, format, columns...
  bool define(const std::vector<std::string_view>& cells) {
    if (cells.size() < 4) return false;
    const auto type = number_of(cells[1]);
    const auto length = number_of(cells[2]);
    if (!type) return cells[1] == "Type";  // a header line of a converted log
    if (!(*type >= 0.0 && *type < 256.0) || !length || cells[3].empty()) return false;
    TextTable table;
    table.format.type = static_cast<std::uint8_t>(*type);
    table.format.length = *length >= 0.0 && *length < 65536.0 ? static_cast<std::uint32_t>(*length) : 0;
    table.format.name = internal::printable(cells[3]);
    table.format.characters = cells.size() > 4 ? internal::printable(cells[4]) : "";
    for (std::size_t i = 5; i < cells.size(); ++i) {
      if (i > 5) table.format.labels += ',';
      table.format.labels += internal::printable(cells[i]);
    }
    if (const auto known = index_.find(table.format.name); known != index_.end()) {
      if (tables_[known->second].format == table.format) return true;
    }
    if (tables_.size() >= 2048) return false;
    table.columns = dataflash_columns(table.format, false);
    table.time = dataflash_time(table.columns);
    table.numbers.resize(table.columns.size());
    table.texts.resize(table.columns.size());
    index_[table.format.name] = tables_.size();
    tables_.push_back(std::move(table));
    return true;
  }

  bool take(TextTable& table, std::vector<std::string_view>& cells) {
    const std::size_t count = table.columns.size();
    if (cells.size() - 1 < count) return false;
    if (cells.size() - 1 > count && !join_text(table, cells)) return false;
    values_.assign(count, kNaN);
    for (std::size_t i = 0; i < count; ++i) {
      const DataFlashColumn& column = table.columns[i];
      const std::string_view cell = cells[i + 1];
      if (is_text_type(column.type) || column.type == 'a' || cell.empty()) continue;
      const auto number = number_of(cell);
      // Modes and unit ids are written as words or letters by some writers.
      if (!number && !(column.type == 'M' || (column.type == 'b' && cell.size() == 1))) return false;
      if (number) values_[i] = *number;
    }
    double stamp = clock_;
    if (table.time) {
      stamp = table.time->scale * values_[table.time->column];
      if (std::isfinite(stamp)) clock_ = stamp;
      restarts_.add(stamp, rows_);
    }
    table.stamps.push_back(stamp);
    table.places.push_back(rows_++);
    for (std::size_t i = 0; i < count; ++i) {
      const char type = table.columns[i].type;
      if (is_text_type(type) || type == 'a' || type == 'M' || type == 'b') table.texts[i].push_back(cells[i + 1]);
      if (!is_text_type(type)) table.numbers[i].push_back(values_[i]);
    }
    return true;
  }

  /// More commas than columns belong to a text; the last text column takes them.
  bool join_text(const TextTable& table, std::vector<std::string_view>& cells) const {
    const std::size_t extra = cells.size() - 1 - table.columns.size();
    for (std::size_t i = table.columns.size(); i-- > 0;) {
      if (!is_text_type(table.columns[i].type)) continue;
      const std::string_view first = cells[i + 1];
      const std::string_view last = cells[i + 1 + extra];
      cells[i + 1] = std::string_view(first.data(), at(last.data() + last.size() - first.data()));
      const auto begin = cells.begin() + signed_index(i + 2);
      cells.erase(begin, begin + signed_index(extra));
      return true;
    }
    return false;
  }

  std::string_view data_;
  Log& log_;
  std::vector<TextTable> tables_;
  std::map<std::string, std::size_t, std::less<>> index_;
  std::vector<double> values_;
  ClockRestarts restarts_;
  std::uint64_t rows_ = 0;
  double clock_ = 0.0;
};

// Unit ids are letters, or their codes.
char id_of(const TextTable& table, std::size_t column, std::size_t row) {
  const double code = table.numbers[column][row];
  const std::string_view cell = table.texts[column].size() > row ? table.texts[column][row] : std::string_view();
  // A single digit is ambiguous: '0' to '9' are multiplier ids themselves, codes below 10 are not letters.
  if (cell.size() == 1) return cell[0];
  return std::isfinite(code) && code >= 0.0 && code < 127.0 ? static_cast<char>(code) : '\0';
}

void read_units(const std::vector<TextTable>& tables, DataFlashUnits& units) {
  for (const TextTable& table : tables) {
    const auto column = [&](std::string_view name) -> std::optional<std::size_t> {
      for (std::size_t i = 0; i < table.columns.size(); ++i) {
        if (table.columns[i].name == name) return i;
      }
      return std::nullopt;
    };
    const auto is_text = [&](std::optional<std::size_t> i) { return i && is_text_type(table.columns[*i].type); };
    const auto id = column("Id");
    const std::size_t rows = table.stamps.size();
    if (table.format.name == "UNIT" && id && table.columns[*id].type == 'b' && is_text(column("Label"))) {
      for (std::size_t i = 0; i < rows; ++i) units.add_unit(id_of(table, *id, i), table.texts[*column("Label")][i]);
    } else if (table.format.name == "MULT" && id && table.columns[*id].type == 'b' && column("Mult") &&
               !is_text(column("Mult"))) {
      for (std::size_t i = 0; i < rows; ++i) {
        units.add_multiplier(id_of(table, *id, i), table.numbers[*column("Mult")][i]);
      }
    } else if (table.format.name == "FMTU" && is_text(column("UnitIds")) && is_text(column("MultIds")) &&
               column("FmtType") && !is_text(column("FmtType"))) {
      for (std::size_t i = 0; i < rows; ++i) {
        const double type = table.numbers[*column("FmtType")][i];
        if (!(type >= 0.0 && type < 256.0)) continue;
        units.add_format(static_cast<std::uint8_t>(type), table.texts[*column("UnitIds")][i],
                         table.texts[*column("MultIds")][i]);
      }
    }
  }
}

LogTopic build(const TextTable& table, const std::vector<std::uint64_t>& rows,
               std::optional<std::size_t> instance_column) {
  LogTopic topic;
  topic.name = table.format.name;
  std::vector<double> stamps;
  stamps.reserve(rows.size());
  for (const std::uint64_t row : rows) stamps.push_back(table.stamps[row]);
  OrderedStamps ordered = order_stamps(std::move(stamps));
  std::vector<std::uint64_t> order;
  if (ordered.row.empty() && !ordered.time.empty()) {
    order = rows;
  } else {
    for (const std::uint64_t i : ordered.row) order.push_back(rows[i]);
  }
  topic.spikes = ordered.spikes;
  topic.reordered = ordered.reordered;
  topic.doubled = table.time ? ordered.doubled : 0;
  topic.time = make_time_base(std::move(ordered.time));
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const DataFlashColumn& column = table.columns[i];
    if ((table.time && table.time->column == i) || instance_column == i) continue;
    LogField field{column.name, column.unit, column.scale, {}, {}};
    const std::vector<double>& numbers = table.numbers[i];
    // A mode that is written as a word everywhere is a text.
    const bool words = column.type == 'M' && std::all_of(rows.begin(), rows.end(),
                                                         [&](std::uint64_t row) { return std::isnan(numbers[row]); });
    if (is_text_type(column.type) || column.type == 'a' || words) {
      TextColumn texts;
      for (const std::uint64_t row : order) texts.push_back(table.texts[i][row]);
      field.values = Column(std::move(texts));
    } else {
      std::vector<double> values;
      values.reserve(order.size());
      for (const std::uint64_t row : order) values.push_back(numbers[row]);
      field.values = Column(std::move(values));
    }
    topic.fields.push_back(std::move(field));
  }
  return topic;
}

}  // namespace

bool is_dataflash_text(std::string_view bytes) {
  const std::string_view start = bytes.substr(0, 65536);
  for (std::size_t at = start.find("FMT,"); at != std::string_view::npos; at = start.find("FMT,", at + 1)) {
    if (at == 0 || start[at - 1] == '\n') return true;
  }
  return false;
}

Log read_dataflash_text(std::string_view bytes, std::string source) {
  Log log;
  log.source = std::move(source);
  log.format = "ArduPilot DataFlash text";
  if (bytes.empty()) throw InputError(log.source, "the file is empty");
  TextReader reader(bytes, log);
  reader.run();
  if (reader.tables().empty()) throw InputError(log.source, "not an ArduPilot text log: no line starts with 'FMT,'");
  DataFlashUnits units;
  read_units(reader.tables(), units);
  for (TextTable& table : reader.tables()) {
    if (table.stamps.empty()) continue;
    units.apply(table.format, table.columns, false);
    const auto instance_column = units.instance_column(table.format, table.columns);
    std::map<int, std::vector<std::uint64_t>> parts;
    for (std::size_t i = 0; i < table.stamps.size(); ++i) {
      double instance = 0.0;
      if (instance_column) instance = table.numbers[*instance_column][i];
      parts[instance >= 0.0 && instance < 256.0 ? static_cast<int>(instance) : 0].push_back(i);
    }
    for (const auto& [instance, rows] : parts) {
      log.topics.push_back(build(table, rows, instance_column));
      log.topics.back().instance = instance;
    }
    table = TextTable{};
  }
  read_dataflash_events(log);
  internal::finish(log);
  return log;
}

}  // namespace veridyn::io
