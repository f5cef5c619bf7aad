#include "veridyn/io/matlab/mat.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/io/dataflash/dataflash_schema.hpp"
#include "veridyn/io/log/mapped_file.hpp"
#include "veridyn/io/log/time_stamps.hpp"
#include "veridyn/io/matlab/mat_value.hpp"
#include "veridyn/io/tables/csv_header.hpp"
#include "veridyn/io/tables/known_tables.hpp"
#include "veridyn/io/tables/time_column.hpp"
#include "veridyn/io/tables/unit_words.hpp"

namespace veridyn::io {
namespace {

constexpr std::string_view kMatlab73 = "MATLAB 7.3 MAT-file";

bool is_vector(const MatValue& value) {
  return value.kind == MatValue::Kind::kNumbers && value.numbers.size() > 1 &&
         std::count_if(value.extents.begin(), value.extents.end(), [](std::size_t n) { return n != 1; }) == 1;
}

/// Rows and columns of equal segments one behind the other.
bool is_segments(const MatValue& value) {
  return value.kind == MatValue::Kind::kNumbers && value.extents.size() == 3 && value.numbers.size() > 1;
}

bool is_matrix(const MatValue& value) {
  return value.kind == MatValue::Kind::kNumbers && value.extents.size() == 2 && value.numbers.size() > 1;
}

/// Orders rows by their stamps and gives every column the same order.
void set_series(LogTopic& topic, std::vector<double> stamps, std::vector<LogField> fields,
                std::vector<std::vector<double>> columns) {
  OrderedStamps ordered = order_stamps(std::move(stamps));
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (!ordered.row.empty() || ordered.time.empty()) {
      std::vector<double> chosen;
      for (const std::uint64_t row : ordered.row) chosen.push_back(columns[i][row]);
      columns[i] = std::move(chosen);
    }
    fields[i].values = Column(std::move(columns[i]));
    topic.fields.push_back(std::move(fields[i]));
  }
  topic.spikes = ordered.spikes;
  topic.reordered = ordered.reordered;
  topic.doubled = ordered.doubled;
  topic.time = make_time_base(std::move(ordered.time));
}

/// View of the variables of a file, of which it builds the topics of a log.
class Builder {
 public:
  Builder(Log& log, const TableOptions& options) : log_(log), options_(options) {
    file_.kind = MatValue::Kind::kStruct;
  }

  void take(MatValue&& variable) {
    if (variable.kind == MatValue::Kind::kOther) {
      log_.damage.notes.push_back(not_read(variable));
      return;
    }
    file_.items.push_back(std::move(variable));
  }

  void finish() {
    if (!options_.columns.empty() || !options_.variable.empty()) {
      take_named_columns(named_matrix());
      return;
    }
    if (MatValue* fdata = sidpac_array()) {
      take_named_columns(*fdata);
      return;
    }
    take_labelled();
    take_struct(file_, "", 0);
    if (!options_.time_column.empty() && !time_found_) {
      throw InputError(log_.source, fmt::format("holds no vector '{}' for the time; it holds {}", options_.time_column,
                                                held_.empty() ? "other series" : held()));
    }
    const bool series =
        std::any_of(log_.topics.begin(), log_.topics.end(), [](const LogTopic& t) { return !t.schema; });
    if (series || held_.empty()) return;
    log_.damage.notes.push_back(fmt::format(
        "no vector of stamps was found, so nothing is a series; the file holds {}. Name the stamps: time = {{ column = "
        "\"...\" }} in [data]; or, of rows without stamps, the rate: time = {{ rate = \"... Hz\" }}; columns = [...] "
        "names those of a matrix",
        held()));
  }

 private:
  static std::string not_read(const MatValue& variable) {
    const bool table = variable.class_name == "table" || variable.class_name == "timetable";
    if (variable.class_name.empty()) return fmt::format("variable '{}' is of a kind that is not read", variable.name);
    if (!table) {
      return fmt::format(
          "variable '{}' is an object of class {}, which only MATLAB reads: save what it holds as a struct",
          variable.name, variable.class_name);
    }
    return fmt::format(
        "variable '{0}' is a {1}, which only MATLAB reads: save it as a struct, s = table2struct({2}, 'ToScalar', "
        "true), "
        "or by {3}({0}, 'log.csv')",
        variable.name, variable.class_name,
        variable.class_name == "table" ? variable.name : fmt::format("timetable2table({})", variable.name),
        variable.class_name == "table" ? "writetable" : "writetimetable");
  }

  /// What was found without stamps.
  [[nodiscard]] std::string held() const {
    constexpr std::size_t kListed = 20;
    const std::vector<std::string> first(held_.begin(), held_.begin() + signed_index(std::min(kListed, held_.size())));
    return fmt::format("{}{}", fmt::join(first, ", "),
                       held_.size() > kListed ? fmt::format(" and {} more", held_.size() - kListed) : "");
  }

  static std::string in_words(const std::string& path, const MatValue& value) {
    return fmt::format("{} ({})", path, fmt::join(value.extents, " x "));
  }

  /// SIDPAC's array, which its workspaces hold as `fdata`, and as `fdatao` before it was changed.
  MatValue* sidpac_array() {
    const auto fdata = std::ranges::find(file_.items, "fdata", &MatValue::name);
    if (fdata == file_.items.end() || !(is_matrix(*fdata) || is_segments(*fdata))) return nullptr;
    if (fdata->extents[0] < 2 || internal::sidpac_columns(fdata->extents[1]).empty()) return nullptr;
    log_.damage.notes.emplace_back(
        "fdata is taken for SIDPAC's array, whose columns have names and units; `columns` in [data] gives others");
    if (std::ranges::find(file_.items, "fdatao", &MatValue::name) != file_.items.end())
      log_.damage.notes.emplace_back(
          "fdatao is not read; `variable = \"fdatao\"` in [data] takes it in place of fdata");
    return &*fdata;
  }

  /// The matrix that the options name, or with as many columns as they name.
  MatValue& named_matrix() {
    const std::size_t count = options_.columns.size();
    std::vector<MatValue*> fitting;
    std::vector<std::string> names;
    for (MatValue& value : file_.items) {
      if (value.kind != MatValue::Kind::kNumbers) continue;
      held_.push_back(in_words(value.name, value));
      names.push_back(value.name);
      const bool table = (is_matrix(value) || is_segments(value)) && value.extents[0] > 1;
      const bool asked = options_.variable.empty() ? value.extents.size() > 1 && value.extents[1] == count
                                                   : value.name == options_.variable;
      if (table && asked) fitting.push_back(&value);
    }
    const std::string holds = fmt::format("it holds {}", held_.empty() ? "no numbers" : held());
    if (!options_.variable.empty() && fitting.empty()) {
      throw InputError(log_.source, fmt::format("holds no matrix '{}', which `variable` names{}: {}", options_.variable,
                                                suggestion(options_.variable, names), holds));
    }
    if (fitting.size() != 1) {
      throw InputError(log_.source,
                       fmt::format("`columns` names {} columns, and {} matrices have as many: {}{}", count,
                                   fitting.empty() ? std::string("no") : std::to_string(fitting.size()), holds,
                                   fitting.empty() ? std::string()
                                                   : fmt::format("; say which, variable = \"{}\" in [data]",
                                                                 fitting.front()->name)));
    }
    return *fitting.front();
  }

  /// Names and units of a matrix: those that the options give, or SIDPAC's.
  [[nodiscard]] std::vector<internal::Header> headers_of(const MatValue& matrix) const {
    const std::size_t count = matrix.extents[1];
    std::vector<internal::Header> headers;
    for (const std::string& column : options_.columns)
      headers.push_back(internal::split_header(column, true, log_.source));
    if (headers.empty()) headers = internal::sidpac_columns(count);
    if (headers.empty()) {
      throw InputError(log_.source, fmt::format("{} has {} columns; name them, columns = [\"time[s]\", ...] in [data]",
                                                matrix.name, count));
    }
    if (headers.size() != count) {
      throw InputError(log_.source,
                       fmt::format("`columns` names {} columns, {} has {}", headers.size(), matrix.name, count));
    }
    return headers;
  }

  /// The first row of the segment that is read, of a matrix of three dimensions that of the options, or the first.
  std::size_t begin_of_segment(const MatValue& matrix) {
    if (!is_segments(matrix)) return 0;
    const std::size_t segments = matrix.extents[2];
    const std::size_t part = std::max<std::size_t>(1, options_.part);
    if (part > segments)
      throw InputError(log_.source, fmt::format("has no part {}: {} has {} segments", part, matrix.name, segments));
    log_.part = part;
    log_.parts = segments;
    if (segments > 1) {
      log_.damage.notes.push_back(
          fmt::format("{} has {} segments; part {} is read, `part = {}` in [data] takes another", matrix.name, segments,
                      part, part == 1 ? 2 : 1));
    }
    return (part - 1) * matrix.extents[0] * matrix.extents[1];
  }

  /// The columns of a matrix are series.
  void take_named_columns(MatValue& matrix) {
    const std::vector<internal::Header> headers = headers_of(matrix);
    const std::size_t count = headers.size();
    const std::size_t segment = begin_of_segment(matrix);
    const std::size_t rows = matrix.extents[0];
    std::vector<std::string> names;
    for (const internal::Header& header : headers) names.push_back(header.name);
    const auto column_of = [&](std::size_t k) {
      const auto begin = matrix.numbers.begin() + signed_index(segment + k * rows);
      return std::vector<double>(begin, begin + signed_index(rows));
    };
    std::optional<std::size_t> time;
    if (!(options_.rate > 0.0)) {
      time = internal::find_time_column(names, options_, log_.source);
      if (!time)
        throw InputError(log_.source,
                         "none of `columns` is the time; name one so, or give time = { rate = \"... Hz\" }");
    }
    LogTopic topic;
    std::vector<LogField> fields;
    std::vector<std::vector<double>> columns;
    for (std::size_t k = 0; k < count; ++k) {
      if (time == k) continue;
      std::vector<double> column = column_of(k);
      // SIDPAC's array has zeros in place of what was not measured.
      if (options_.columns.empty() && std::ranges::all_of(column, [](double x) { return x == 0.0; })) continue;
      fields.push_back({headers[k].name, headers[k].unit.empty() ? "1" : headers[k].unit, 1.0, {}, {}});
      columns.push_back(std::move(column));
    }
    std::vector<double> stamps = time ? column_of(*time) : made_stamps(rows);
    if (time) to_seconds(headers[*time], stamps);
    set_series(topic, std::move(stamps), std::move(fields), std::move(columns));
    log_.topics.push_back(std::move(topic));
  }

  [[nodiscard]] std::vector<double> made_stamps(std::size_t rows) const {
    std::vector<double> stamps(rows);
    for (std::size_t i = 0; i < rows; ++i) stamps[i] = static_cast<double>(i) / options_.rate;
    return stamps;
  }

  void to_seconds(const internal::Header& header, std::vector<double>& stamps) {
    const internal::TimeChoice choice = internal::time_scale(header, options_, stamps, log_.source);
    if (!choice.note.empty()) log_.damage.notes.push_back(choice.note);
    for (double& stamp : stamps) stamp *= choice.scale;
  }

  /// The vector of stamps of a struct, or null.
  const MatValue* stamps_of(const MatValue& value, const std::string& path) {
    std::vector<const MatValue*> vectors;
    std::vector<std::string> names;
    for (const MatValue& item : value.items) {
      if (!is_vector(item)) continue;
      if (item.row_times && options_.time_column.empty()) return &item;
      const std::string full = path.empty() ? item.name : fmt::format("{}.{}", path, item.name);
      const bool asked = full == options_.time_column || item.name == options_.time_column;
      time_found_ = time_found_ || asked;
      if (asked) return &item;
      vectors.push_back(&item);
      names.push_back(item.name);
    }
    if (!options_.time_column.empty()) return nullptr;
    const auto found = internal::find_time_column(names, {}, log_.source);
    return found ? vectors[*found] : nullptr;
  }

  /// The most rows of an array, where the options give their rate.
  [[nodiscard]] std::size_t rows_at_rate(const MatValue& value) const {
    std::size_t rows = 0;
    for (const MatValue& item : value.items) {
      if (is_vector(item)) rows = std::max(rows, item.numbers.size());
      if (!is_vector(item) && is_matrix(item)) rows = std::max(rows, item.extents[0]);
    }
    return rows;
  }

  void take_labelled() {
    std::map<std::string, std::vector<std::string>> labels;
    for (const MatValue& value : file_.items) {
      constexpr std::string_view kEnding = "_label";
      if (value.kind != MatValue::Kind::kCell || value.name.size() <= kEnding.size()) continue;
      if (value.name.substr(value.name.size() - kEnding.size()) != kEnding) continue;
      std::vector<std::string> names;
      for (const MatValue& item : value.items) names.push_back(item.text);
      labels[value.name.substr(0, value.name.size() - kEnding.size())] = std::move(names);
    }
    if (labels.empty()) return;
    log_.format = "MATLAB export of an ArduPilot log";
    std::vector<MatValue> others;
    for (MatValue& value : file_.items) {
      const auto found = labels.find(value.name);
      const bool matrix = found != labels.end() && is_matrix(value) && value.extents[1] == found->second.size();
      if (matrix) {
        take_message(value, found->second);
      } else if (value.name.size() <= 6 || value.name.substr(value.name.size() - 6) != "_label") {
        others.push_back(std::move(value));
      }
    }
    file_.items = std::move(others);
  }

  void take_message(const MatValue& value, const std::vector<std::string>& labels) {
    DataFlashFormat format;
    format.name = value.name;
    for (const std::string& label : labels) {
      if (!format.labels.empty()) format.labels += ',';
      format.labels += label;
      format.characters += 'd';
    }
    std::vector<DataFlashColumn> columns = dataflash_columns(format, false);
    const auto time = dataflash_time(columns);
    const std::size_t rows = value.extents[0];
    LogTopic topic;
    topic.name = value.name;
    std::vector<LogField> fields;
    std::vector<std::vector<double>> series;
    std::vector<double> stamps;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const auto begin = value.numbers.begin() + signed_index(k * rows);
      std::vector<double> numbers(begin, begin + signed_index(rows));
      if (time && time->column == k) {
        for (double& stamp : numbers) stamp *= time->scale;
        stamps = std::move(numbers);
        continue;
      }
      const KnownUnit known = known_ardupilot_unit(topic.name, columns[k].name);
      const bool position = columns[k].name == "Lat" || columns[k].name == "Lng";
      fields.push_back({columns[k].name, position ? "deg" : known.unit, known.scale, {}, {}});
      series.push_back(std::move(numbers));
    }
    if (time) {
      set_series(topic, std::move(stamps), std::move(fields), std::move(series));
    } else {
      for (std::size_t k = 0; k < fields.size(); ++k) {
        fields[k].shape = {rows};
        fields[k].values = Column(std::move(series[k]));
      }
      topic.fields = std::move(fields);
      topic.schema = true;
    }
    log_.topics.push_back(std::move(topic));
  }

  // `name` is the path of the struct, empty for the file.
  void take_struct(MatValue& value, const std::string& name, int depth) {
    const bool made = options_.rate > 0.0;
    const MatValue* time = made ? nullptr : stamps_of(value, name);
    const std::size_t rows = made ? rows_at_rate(value) : time != nullptr ? time->numbers.size() : 0;
    LogTopic series;
    LogTopic table;
    series.name = table.name = name;
    table.schema = true;
    std::vector<LogField> fields;
    std::vector<std::vector<double>> columns;
    std::map<std::string, int> seen;
    for (MatValue& item : value.items) {
      if (&item == time) continue;
      std::string label = item.name;
      if (const int copy = ++seen[label]; copy > 1) label += fmt::format("({})", copy);  // further struct elements
      const std::string path = name.empty() ? label : fmt::format("{}.{}", name, label);
      switch (item.kind) {
        case MatValue::Kind::kStruct:
          if (depth < 8) take_struct(item, path, depth + 1);
          break;
        case MatValue::Kind::kText:
          log_.information[path] = item.text;
          break;
        case MatValue::Kind::kNumbers:
          if (rows > 1 && fits(item, rows)) {
            add_series(item, label, rows, fields, columns);
          } else {
            held_.push_back(in_words(path, item));
            LogField field{label, "1", 1.0, Column(std::move(item.numbers)), std::move(item.extents)};
            table.fields.push_back(std::move(field));
          }
          break;
        case MatValue::Kind::kOther:
          if (!item.class_name.empty()) log_.damage.notes.push_back(not_read(item));
          break;
        case MatValue::Kind::kCell:
          break;
      }
    }
    if (!fields.empty()) {
      std::vector<double> stamps = made ? made_stamps(rows) : time->numbers;
      if (!made) to_seconds({time->name, time->row_times ? "s" : unit_in_words(time->unit).value_or("")}, stamps);
      set_series(series, std::move(stamps), std::move(fields), std::move(columns));
      log_.topics.push_back(std::move(series));
    }
    if (!table.fields.empty()) log_.topics.push_back(std::move(table));
  }

  static bool fits(const MatValue& item, std::size_t rows) {
    if (is_vector(item)) return item.numbers.size() == rows;
    return is_matrix(item) && item.extents[0] == rows;
  }

  /// In the words of `parse_unit`: "1" where none is given, or none that is known, which is noted.
  std::string unit_of(const MatValue& item) {
    if (item.unit.empty()) return "1";
    if (const auto known = unit_of_column(item.unit, item.name)) return *known;
    log_.damage.notes.push_back(fmt::format("the unit of column '{}' is not known: {}", item.name, item.unit));
    return "1";
  }

  void add_series(MatValue& item, const std::string& label, std::size_t rows, std::vector<LogField>& fields,
                  std::vector<std::vector<double>>& columns) {
    const std::string unit = unit_of(item);
    if (item.numbers.size() == rows) {
      fields.push_back({label, unit, 1.0, {}, {}});
      columns.push_back(std::move(item.numbers));
      return;
    }
    for (std::size_t k = 0; k * rows < item.numbers.size(); ++k) {
      const auto begin = item.numbers.begin() + signed_index(k * rows);
      fields.push_back({fmt::format("{}[{}]", label, k), unit, 1.0, {}, {}});
      columns.emplace_back(begin, begin + signed_index(rows));
    }
    item.numbers = {};
  }

  Log& log_;
  TableOptions options_;
  MatValue file_;
  std::vector<std::string> held_;  ///< what is no series, with its extents
  bool time_found_ = false;
};

Log read(std::string_view bytes, std::string source, const std::string* path, const TableOptions& options) {
  Log log;
  log.source = std::move(source);
  log.format = "MATLAB";
  if (bytes.empty()) throw InputError(log.source, "the file is empty");
  if (!is_mat(bytes)) {
    throw InputError(log.source, "not a MATLAB file of version 5 to 7.3 (save it with '-v7'; version 4 is not read)");
  }
  Builder builder(log, options);
  const auto take = [&](MatValue&& value) { builder.take(std::move(value)); };
  if (bytes.substr(0, kMatlab73.size()) == kMatlab73) {
    if (path == nullptr) throw InputError(log.source, "a MATLAB 7.3 file can only be read from disk");
    read_mat73(*path, take, log.damage);
  } else {
    read_mat5(bytes, log.source, take, log.damage);
  }
  builder.finish();
  internal::finish(log);
  return log;
}

}  // namespace

bool is_mat(std::string_view bytes) {
  if (bytes.substr(0, kMatlab73.size()) == kMatlab73) return true;
  if (bytes.size() < 128) return false;
  const std::string_view mark = bytes.substr(124, 4);
  return mark == std::string_view("\x00\x01IM", 4) || mark == std::string_view("\x01\x00MI", 4);
}

Log read_mat(std::string_view bytes, std::string source, const TableOptions& options) {
  return read(bytes, std::move(source), nullptr, options);
}

Log read_mat_file(const std::filesystem::path& path, const TableOptions& options) {
  const MappedFile file(path);
  const std::string name = path.string();
  return read(file.bytes(), name, &name, options);
}

}  // namespace veridyn::io
