#include "veridyn/io/matlab/mat.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/io/dataflash/dataflash_schema.hpp"
#include "veridyn/io/log/mapped_file.hpp"
#include "veridyn/io/log/time_stamps.hpp"
#include "veridyn/io/matlab/mat_value.hpp"

namespace veridyn::io {
namespace {

constexpr std::string_view kMatlab73 = "MATLAB 7.3 MAT-file";

struct TimeName {
  std::string_view name;
  double scale;
};
constexpr TimeName kTimeNames[] = {{"time", 1.0},  {"t", 1.0},       {"Time", 1.0},    {"time_s", 1.0},    {"t_s", 1.0},
                                   {"TimeS", 1.0}, {"TimeMS", 1e-3}, {"TimeUS", 1e-6}, {"timestamp", 1e-6}};

bool is_vector(const MatValue& value) {
  return value.kind == MatValue::Kind::kNumbers && value.numbers.size() > 1 &&
         std::count_if(value.extents.begin(), value.extents.end(), [](std::size_t n) { return n != 1; }) == 1;
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
  explicit Builder(Log& log) : log_(log) { file_.kind = MatValue::Kind::kStruct; }

  void take(MatValue&& variable) {
    if (variable.kind == MatValue::Kind::kOther) {
      log_.damage.notes.push_back(fmt::format("variable '{}' is of a kind that is not read", variable.name));
      return;
    }
    file_.items.push_back(std::move(variable));
  }

  void finish() {
    take_labelled();
    take_struct(file_, "", 0);
  }

 private:
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
    const MatValue* time = nullptr;
    double scale = 1.0;
    for (const TimeName& known : kTimeNames) {
      const MatValue* candidate = value.find(known.name);
      if (time == nullptr && candidate != nullptr && is_vector(*candidate)) {
        time = candidate;
        scale = known.scale;
      }
    }
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
          if (time != nullptr && fits(item, time->numbers.size())) {
            add_series(item, label, time->numbers.size(), fields, columns);
          } else {
            LogField field{label, "1", 1.0, Column(std::move(item.numbers)), std::move(item.extents)};
            table.fields.push_back(std::move(field));
          }
          break;
        case MatValue::Kind::kCell:
        case MatValue::Kind::kOther:
          break;
      }
    }
    if (time != nullptr && !fields.empty()) {
      std::vector<double> stamps = time->numbers;
      for (double& stamp : stamps) stamp *= scale;
      set_series(series, std::move(stamps), std::move(fields), std::move(columns));
      log_.topics.push_back(std::move(series));
    }
    if (!table.fields.empty()) log_.topics.push_back(std::move(table));
  }

  static bool fits(const MatValue& item, std::size_t rows) {
    if (is_vector(item)) return item.numbers.size() == rows;
    return is_matrix(item) && item.extents[0] == rows;
  }

  static void add_series(MatValue& item, const std::string& label, std::size_t rows, std::vector<LogField>& fields,
                         std::vector<std::vector<double>>& columns) {
    if (item.numbers.size() == rows) {
      fields.push_back({label, "1", 1.0, {}, {}});
      columns.push_back(std::move(item.numbers));
      return;
    }
    for (std::size_t k = 0; k * rows < item.numbers.size(); ++k) {
      const auto begin = item.numbers.begin() + signed_index(k * rows);
      fields.push_back({fmt::format("{}[{}]", label, k), "1", 1.0, {}, {}});
      columns.emplace_back(begin, begin + signed_index(rows));
    }
  }

  Log& log_;
  MatValue file_;
};

Log read(std::string_view bytes, std::string source, const std::string* path) {
  Log log;
  log.source = std::move(source);
  log.format = "MATLAB";
  if (bytes.empty()) throw InputError(log.source, "the file is empty");
  if (!is_mat(bytes)) {
    throw InputError(log.source, "not a MATLAB file of version 5 to 7.3 (save it with '-v7'; version 4 is not read)");
  }
  Builder builder(log);
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

Log read_mat(std::string_view bytes, std::string source) { return read(bytes, std::move(source), nullptr); }

Log read_mat_file(const std::filesystem::path& path) {
  const MappedFile file(path);
  const std::string name = path.string();
  return read(file.bytes(), name, &name);
}

}  // namespace veridyn::io
