#include "veridyn/io/dataflash/dataflash.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "veridyn/core/bytes.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/io/dataflash/dataflash_schema.hpp"
#include "veridyn/io/log/clock_restarts.hpp"
#include "veridyn/io/log/gather.hpp"
#include "veridyn/io/log/time_stamps.hpp"

namespace veridyn::io {
namespace {

constexpr unsigned char kHead1 = 0xA3;
constexpr unsigned char kHead2 = 0x95;
constexpr std::uint8_t kFormatType = 128;
constexpr std::uint32_t kFormatLength = 89;
constexpr std::string_view kFormatHead{"\xA3\x95\x80", 3};

/// A message type as one FMT defines it, with the places of its records.
struct Layout {
  DataFlashFormat format;
  std::vector<DataFlashColumn> columns;
  std::optional<DataFlashTime> time;
  std::vector<std::uint64_t> records;
  std::vector<double> borrowed_time;  ///< for types without stamps: that of the record before [s]
};

double load_stamp(const char* record, const DataFlashColumn& column) {
  const char* const from = record + column.offset;
  switch (column.type) {
    case 'Q':
      return static_cast<double>(load_number<std::uint64_t>(from));
    case 'q':
      return static_cast<double>(load_number<std::int64_t>(from));
    case 'i':
      return static_cast<double>(load_number<std::int32_t>(from));
    case 'd':
      return load_number<double>(from);
    default:
      return static_cast<double>(load_number<std::uint32_t>(from));
  }
}

/// The stamp that messages without one borrow; a single stamp far from the others is not passed on.
class RunningClock {
 public:
  void tick(double stamp) {
    constexpr double kNear_s = 60.0;
    if (!started_ || std::abs(stamp - now_) < kNear_s || std::abs(stamp - doubtful_) < kNear_s) {
      now_ = stamp;
      started_ = true;
    }
    doubtful_ = stamp;
  }
  [[nodiscard]] double now() const { return now_; }

 private:
  double now_ = 0.0;
  double doubtful_ = kInfinity;
  bool started_ = false;
};

/// View of the bytes of a log: finds its messages and puts them in order.
class Indexer {
 public:
  explicit Indexer(std::string_view bytes) : data_(bytes) {
    DataFlashFormat self{kFormatType, kFormatLength, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns"};
    define(self);
  }

  void run(LogDamage& damage) {
    std::size_t at = 0;
    const std::size_t end = data_.size();
    bool cut = false;
    while (at < end) {
      if (!is_record(at)) {
        at = skip_to(at, damage);
        continue;
      }
      const auto type = static_cast<std::uint8_t>(data_[at + 2]);
      const std::size_t next = at + length_[type];
      if (next > end) {
        cut = true;
        at = skip_to(at, damage);
        continue;
      }
      if (!ends_well(next)) {
        // Either the next record is damaged or this one was cut short: then a sound record begins inside of it.
        const std::size_t inside = find_record(at + 3, next);
        if (inside < next) {
          count_lost(at, inside, damage);
          at = inside;
          continue;
        }
      }
      accept(at, type);
      at = next;
    }
    if (cut) damage.notes.emplace_back("the log ends in the middle of a record");
    restarts_.finish();
  }

  [[nodiscard]] const ClockRestarts& restarts() const { return restarts_; }
  [[nodiscard]] bool found_format() const { return formats_read_ > 0; }
  std::vector<Layout>& layouts() { return layouts_; }

 private:
  [[nodiscard]] bool has_head(std::size_t at) const {
    return at + 3 <= data_.size() && static_cast<unsigned char>(data_[at]) == kHead1 &&
           static_cast<unsigned char>(data_[at + 1]) == kHead2;
  }

  /// A header of a known type; looks for formats further on when the type has not been defined yet.
  bool is_record(std::size_t at) {
    if (!has_head(at)) return false;
    const auto type = static_cast<std::uint8_t>(data_[at + 2]);
    if (length_[type] == 0 && !looked_ahead_) look_ahead();
    return length_[type] != 0;
  }

  /// Whether what follows a record is the end, a header, or too little to decide.
  bool ends_well(std::size_t next) { return next + 3 > data_.size() || is_record(next); }

  bool is_sound(std::size_t at) {
    if (!is_record(at)) return false;
    const std::size_t next = at + length_[static_cast<std::uint8_t>(data_[at + 2])];
    return next <= data_.size() && ends_well(next);
  }

  std::size_t find_record(std::size_t begin, std::size_t end) {
    while (begin < end) {
      const void* const found = std::memchr(data_.data() + begin, kHead1, end - begin);
      if (found == nullptr) return end;
      begin = at(static_cast<const char*>(found) - data_.data());
      if (is_sound(begin)) return begin;
      ++begin;
    }
    return end;
  }

  static void count_lost(std::size_t begin, std::size_t end, LogDamage& damage) {
    damage.bytes_lost += end - begin;
    ++damage.records_lost;
  }

  std::size_t skip_to(std::size_t at, LogDamage& damage) {
    const std::size_t next = find_record(at + 1, data_.size());
    count_lost(at, next, damage);
    return next;
  }

  void accept(std::size_t at, std::uint8_t type) {
    Layout& layout = layouts_[current_[type]];
    const char* const record = data_.data() + at;
    layout.records.push_back(at);
    if (layout.time) {
      const double stamp = layout.time->scale * load_stamp(record, layout.columns[layout.time->column]);
      clock_.tick(stamp);
      restarts_.add(stamp, at);
    } else {
      layout.borrowed_time.push_back(clock_.now());
    }
    if (type == kFormatType) {
      if (const auto format = parse_dataflash_format(data_.substr(at + 3, kFormatLength - 3))) {
        ++formats_read_;
        define(*format);
      }
    }
  }

  void define(const DataFlashFormat& format) {
    if (length_[format.type] != 0) {
      if (layouts_[current_[format.type]].format == format) return;
      if (format.type == kFormatType) return;
    }
    // A firmware defines each type once; far more definitions than that are damage and must not eat the memory.
    if (layouts_.size() >= 2048) return;
    Layout layout;
    layout.format = format;
    layout.columns = dataflash_columns(format, true);
    layout.time = dataflash_time(layout.columns);
    length_[format.type] = format.length;
    current_[format.type] = layouts_.size();
    layouts_.push_back(std::move(layout));
  }

  // Formats may stand after the first records of their type (a ring buffer that has overwritten its start).
  void look_ahead() {
    looked_ahead_ = true;
    for (std::size_t at = data_.find(kFormatHead); at != std::string_view::npos && at + kFormatLength <= data_.size();
         at = data_.find(kFormatHead, at + 3)) {
      const auto format = parse_dataflash_format(data_.substr(at + 3, kFormatLength - 3));
      if (format && length_[format->type] == 0) define(*format);
    }
  }

  std::string_view data_;
  std::array<std::uint32_t, 256> length_{};
  std::array<std::size_t, 256> current_{};
  std::vector<Layout> layouts_;
  RunningClock clock_;
  ClockRestarts restarts_;
  std::size_t formats_read_ = 0;
  bool looked_ahead_ = false;
};

std::string_view text_of(std::string_view data, std::uint64_t record, const DataFlashColumn& column) {
  const std::string_view field = data.substr(record + column.offset, dataflash_size(column.type));
  return field.substr(0, field.find('\0'));
}

void read_units(std::string_view data, const std::vector<Layout>& layouts, DataFlashUnits& units) {
  for (const Layout& layout : layouts) {
    const auto column = [&](std::string_view name, std::string_view types) -> const DataFlashColumn* {
      for (const DataFlashColumn& candidate : layout.columns) {
        if (candidate.name == name && types.find(candidate.type) != std::string_view::npos) return &candidate;
      }
      return nullptr;
    };
    const std::string& name = layout.format.name;
    if (name == "UNIT") {
      const auto* id = column("Id", "bB");
      const auto* label = column("Label", "nNZ");
      if (id == nullptr || label == nullptr) continue;
      for (const auto record : layout.records) units.add_unit(data[record + id->offset], text_of(data, record, *label));
    } else if (name == "MULT") {
      const auto* id = column("Id", "bB");
      const auto* value = column("Mult", "d");
      if (id == nullptr || value == nullptr) continue;
      for (const auto record : layout.records) {
        units.add_multiplier(data[record + id->offset], load_number<double>(data.data() + record + value->offset));
      }
    } else if (name == "FMTU") {
      const auto* type = column("FmtType", "B");
      const auto* unit_ids = column("UnitIds", "N");
      const auto* multiplier_ids = column("MultIds", "N");
      if (type == nullptr || unit_ids == nullptr || multiplier_ids == nullptr) continue;
      for (const auto record : layout.records) {
        units.add_format(static_cast<std::uint8_t>(data[record + type->offset]), text_of(data, record, *unit_ids),
                         text_of(data, record, *multiplier_ids));
      }
    }
  }
}

GatherType gather_type(char character) {
  switch (character) {
    case 'b':
      return GatherType::kInt8;
    case 'B':
    case 'M':
      return GatherType::kUint8;
    case 'h':
    case 'c':
    case 'a':
      return GatherType::kInt16;
    case 'H':
    case 'C':
      return GatherType::kUint16;
    case 'i':
    case 'e':
    case 'L':
      return GatherType::kInt32;
    case 'I':
    case 'E':
      return GatherType::kUint32;
    case 'q':
      return GatherType::kInt64;
    case 'Q':
      return GatherType::kUint64;
    case 'g':
      return GatherType::kHalf;
    case 'd':
      return GatherType::kDouble;
    case 'n':
    case 'N':
    case 'Z':
      return GatherType::kText;
    default:
      return GatherType::kFloat;
  }
}

LogTopic decode(std::string_view data, const Layout& layout, std::vector<std::uint64_t> records,
                std::vector<double> borrowed_time, std::optional<std::size_t> instance_column,
                const ClockRestarts& restarts) {
  LogTopic topic;
  topic.name = layout.format.name;
  std::vector<double> stamps = std::move(borrowed_time);
  if (layout.time) {
    const DataFlashColumn& column = layout.columns[layout.time->column];
    stamps.resize(records.size());
    for (std::size_t i = 0; i < records.size(); ++i) {
      stamps[i] = layout.time->scale * load_stamp(data.data() + records[i], column);
    }
  }
  restarts.shift(stamps, records);
  OrderedStamps ordered = order_stamps(std::move(stamps));
  if (!ordered.row.empty() || ordered.time.empty()) {
    std::vector<std::uint64_t> chosen;
    chosen.reserve(ordered.row.size());
    for (const std::uint64_t row : ordered.row) chosen.push_back(records[row]);
    records = std::move(chosen);
  }
  topic.spikes = ordered.spikes;
  topic.reordered = ordered.reordered;
  topic.doubled = layout.time ? ordered.doubled : 0;
  topic.time = make_time_base(std::move(ordered.time));

  std::vector<GatherColumn> selected;
  for (std::size_t i = 0; i < layout.columns.size(); ++i) {
    const DataFlashColumn& column = layout.columns[i];
    if ((layout.time && layout.time->column == i) || instance_column == i) continue;
    const int elements = column.type == 'a' ? 32 : 1;
    for (int element = 0; element < elements; ++element) {
      LogField field;
      field.name = elements > 1 ? fmt::format("{}[{}]", column.name, element) : column.name;
      field.unit = column.unit;
      field.scale = column.scale;
      topic.fields.push_back(std::move(field));
      selected.push_back({gather_type(column.type), column.offset + 2 * static_cast<std::uint32_t>(element),
                          dataflash_size(column.type)});
    }
  }
  std::vector<Column> columns = gather(data.data(), records, selected);
  for (std::size_t i = 0; i < columns.size(); ++i) topic.fields[i].values = std::move(columns[i]);
  return topic;
}

/// Splits the records of a message by its instance column; a column with more than 32 values is not one.
std::map<int, std::pair<std::vector<std::uint64_t>, std::vector<double>>> split_instances(std::string_view data,
                                                                                          const Layout& layout,
                                                                                          std::size_t column) {
  std::map<int, std::pair<std::vector<std::uint64_t>, std::vector<double>>> parts;
  const std::uint32_t offset = layout.columns[column].offset;
  const std::uint32_t size = dataflash_size(layout.columns[column].type);
  for (std::size_t i = 0; i < layout.records.size(); ++i) {
    const char* const from = data.data() + layout.records[i] + offset;
    int instance = static_cast<unsigned char>(*from);
    if (size == 2) instance = load_number<std::uint16_t>(from);
    if (size == 4) instance = static_cast<int>(load_number<std::uint32_t>(from) & 0x7fffffffU);
    auto& [records, times] = parts[instance];
    if (parts.size() > 32) return {};
    records.push_back(layout.records[i]);
    if (!layout.time) times.push_back(layout.borrowed_time[i]);
  }
  return parts;
}

void note_odd_formats(const std::vector<Layout>& layouts, LogDamage& damage) {
  std::vector<std::string> odd;
  for (const Layout& layout : layouts) {
    std::uint32_t sum = 3;
    for (const char c : layout.format.characters) sum += dataflash_size(c);
    if (sum != layout.format.length && !layout.records.empty()) {
      odd.push_back(fmt::format("{} {}/{}", layout.format.name, layout.format.length, sum));
    }
  }
  if (!odd.empty()) {
    damage.notes.push_back(
        fmt::format("formats whose length is not that of their columns (bytes): {}",
                    fmt::join(odd.begin(), odd.begin() + signed_index(std::min<std::size_t>(odd.size(), 12)), ", ")));
  }
}

}  // namespace

bool is_dataflash(std::string_view bytes) {
  if (bytes.size() >= 3 && static_cast<unsigned char>(bytes[0]) == kHead1 &&
      static_cast<unsigned char>(bytes[1]) == kHead2) {
    return true;
  }
  const std::string_view start = bytes.substr(0, 65536);
  for (std::size_t at = start.find(kFormatHead); at != std::string_view::npos; at = start.find(kFormatHead, at + 1)) {
    if (at + kFormatLength <= start.size() && parse_dataflash_format(start.substr(at + 3))) return true;
  }
  return false;
}

Log read_dataflash(std::string_view bytes, std::string source) {
  Log log;
  log.source = std::move(source);
  log.format = "ArduPilot DataFlash";
  if (bytes.empty()) throw InputError(log.source, "the file is empty");
  Indexer index(bytes);
  index.run(log.damage);
  if (!index.found_format()) {
    throw InputError(log.source, "not an ArduPilot DataFlash log: no FMT record (A3 95 80) in it");
  }
  DataFlashUnits units;
  read_units(bytes, index.layouts(), units);
  note_odd_formats(index.layouts(), log.damage);
  for (Layout& layout : index.layouts()) {
    if (layout.records.empty()) continue;
    units.apply(layout.format, layout.columns, true);
    auto instance_column = units.instance_column(layout.format, layout.columns);
    if (instance_column) {
      auto parts = split_instances(bytes, layout, *instance_column);
      for (auto& [instance, part] : parts) {
        log.topics.push_back(
            decode(bytes, layout, std::move(part.first), std::move(part.second), instance_column, index.restarts()));
        log.topics.back().instance = instance;
      }
      if (!parts.empty()) continue;
    }
    log.topics.push_back(decode(bytes, layout, std::move(layout.records), std::move(layout.borrowed_time), std::nullopt,
                                index.restarts()));
  }
  read_dataflash_events(log);
  index.restarts().report_to(log);
  internal::finish(log);
  return log;
}

}  // namespace veridyn::io
