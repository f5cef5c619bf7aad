#include "veridyn/io/ulog/ulog.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <set>

#include "veridyn/core/error.hpp"
#include "veridyn/io/log/mapped_file.hpp"
#include "veridyn/io/log/time_stamps.hpp"
#include "veridyn/io/ulog/px4_units.hpp"
#include "veridyn/io/ulog/ulog_format.hpp"

namespace veridyn::io {
namespace {

constexpr std::string_view kULogMagic{"\x55\x4C\x6F\x67\x01\x12\x35", 7};
constexpr std::string_view kSync{"\x2F\x73\x13\x20\x25\x0C\xBB\x12", 8};
constexpr std::size_t kHeader = 16;
constexpr std::size_t kIds = 65536;

template <typename T>
T load(const char* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

struct Subscription {
  std::string name;
  int instance = 0;
  std::vector<std::uint64_t> records;  ///< where the data begin, after the id
  std::vector<std::uint16_t> sizes;    ///< bytes of data
};

/// A typed key of information and parameter messages: "float NAME", "char[12] NAME".
struct Key {
  std::string type;
  std::string name;
  std::string_view value;
};

std::optional<Key> parse_key(std::string_view body) {
  if (body.empty()) return std::nullopt;
  const auto length = static_cast<unsigned char>(body[0]);
  if (body.size() < 1U + length) return std::nullopt;
  const std::string_view key = body.substr(1, length);
  const std::size_t blank = key.find(' ');
  if (blank == std::string_view::npos || blank == 0 || blank + 1 == key.size()) return std::nullopt;
  return Key{internal::printable(key.substr(0, blank)), internal::printable(key.substr(blank + 1)),
             body.substr(1U + length)};
}

std::optional<double> number_of(const Key& key) {
  const auto as = [&]<typename T>(T) -> std::optional<double> {
    if (key.value.size() < sizeof(T)) return std::nullopt;
    return static_cast<double>(load<T>(key.value.data()));
  };
  if (key.type == "float") return as(float{});
  if (key.type == "double") return as(double{});
  if (key.type == "int32_t") return as(std::int32_t{});
  if (key.type == "uint32_t") return as(std::uint32_t{});
  if (key.type == "int64_t") return as(std::int64_t{});
  if (key.type == "uint64_t") return as(std::uint64_t{});
  if (key.type == "int16_t") return as(std::int16_t{});
  if (key.type == "uint16_t") return as(std::uint16_t{});
  if (key.type == "int8_t") return as(std::int8_t{});
  if (key.type == "uint8_t" || key.type == "bool") return as(std::uint8_t{});
  return std::nullopt;
}

/// View of the bytes of a log, walked from message to message.
class Walker {
 public:
  Walker(std::string_view bytes, Log& log) : data_(bytes), log_(log), subscription_of_(kIds, -1) {}

  void run() {
    std::size_t begin = kHeader;
    const std::vector<std::size_t> ends = segments();
    for (const std::size_t end : ends) {
      walk(begin, end);
      begin = end;
    }
    if (unknown_ids_ > 0) {
      log_.damage.notes.push_back(fmt::format("{} data messages of ids without a subscription", unknown_ids_));
    }
    if (unknown_types_ > 0) log_.damage.notes.push_back(fmt::format("{} messages of unknown type", unknown_types_));
  }

  std::vector<Subscription>& subscriptions() { return subscriptions_; }
  [[nodiscard]] const ULogFormats& formats() const { return formats_; }

 private:
  /// Ends of the stretches of messages: data appended after a crash start at the offsets in the flag message, wherever
  /// the message before them was cut.
  std::vector<std::size_t> segments() {
    std::vector<std::size_t> ends;
    if (data_.size() >= kHeader + 43 && data_[kHeader + 2] == 'B' &&
        load<std::uint16_t>(data_.data() + kHeader) >= 40) {
      const char* const flags = data_.data() + kHeader + 3;
      const auto incompatible = load<std::uint64_t>(flags + 8);
      if ((incompatible & ~std::uint64_t{1}) != 0) {
        throw InputError(log_.source, fmt::format("this ULog needs features that this reader does not know "
                                                  "(incompatible flag bits {:#x})",
                                                  incompatible & ~std::uint64_t{1}));
      }
      if ((incompatible & 1U) != 0) {
        for (int i = 0; i < 3; ++i) {
          const auto offset = load<std::uint64_t>(flags + 16 + 8 * i);
          if (offset > kHeader + 43 && offset < data_.size()) ends.push_back(static_cast<std::size_t>(offset));
        }
        std::sort(ends.begin(), ends.end());
      }
    }
    ends.push_back(data_.size());
    return ends;
  }

  [[nodiscard]] std::size_t size_at(std::size_t at) const { return load<std::uint16_t>(data_.data() + at); }

  /// Whether a message of a known type that makes sense by itself stands here.
  [[nodiscard]] bool plausible(std::size_t at, std::size_t end) const {
    if (at + 3 > end) return false;
    const std::size_t size = size_at(at);
    if (size == 0 || at + 3 + size > end) return false;
    const char* const body = data_.data() + at + 3;
    switch (data_[at + 2]) {
      case 'D':
        return size > 2 && subscription_of_[load<std::uint16_t>(body)] >= 0;
      case 'F':
        return std::memchr(body, ':', std::min<std::size_t>(size, 256)) != nullptr;
      case 'I':
      case 'P':
        return static_cast<unsigned char>(body[0]) > 2 && size >= 1U + static_cast<unsigned char>(body[0]);
      case 'M':
      case 'Q':
        return size > 2 && static_cast<unsigned char>(body[1]) > 2 && size >= 2U + static_cast<unsigned char>(body[1]);
      case 'A':
        return size > 3 && size < 512 && body[3] > ' ' && body[3] < 127;
      case 'R':
      case 'O':
        return size == 2;
      case 'L':
        return size >= 9;
      case 'C':
        return size >= 11;
      case 'S':
        return size == 8 && std::string_view(body, 8) == kSync;
      case 'B':
        return at == kHeader && size >= 40;
      default:
        return false;
    }
  }

  [[nodiscard]] bool chain(std::size_t at, std::size_t end, int length) const {
    for (int i = 0; i < length; ++i) {
      if (at == end && i > 0) return true;
      if (!plausible(at, end)) return false;
      at += 3 + size_at(at);
    }
    return true;
  }

  [[nodiscard]] std::size_t find_chain(std::size_t begin, std::size_t stop, std::size_t end, int length) const {
    for (std::size_t at = begin; at < stop; ++at) {
      if (chain(at, end, length)) return at;
    }
    return stop;
  }

  void count_lost(std::size_t begin, std::size_t end) {
    log_.damage.bytes_lost += end - begin;
    ++log_.damage.records_lost;
  }

  void walk(std::size_t begin, std::size_t end) {
    constexpr int kSure = 3;  // neighbours in a row that are trusted after damage
    std::size_t at = begin;
    while (at < end) {
      const bool fits = at + 3 <= end && at + 3 + size_at(at) <= end;
      if (plausible(at, end)) {
        const std::size_t next = at + 3 + size_at(at);
        if (next != end && !plausible(next, end) && !skippable(next, end)) {
          // A damaged length leads anywhere: then messages begin inside of this one.
          const std::size_t inside = find_chain(at + 3, next, end, kSure + 1);
          if (inside < next) {
            count_lost(at, inside);
            at = inside;
            continue;
          }
        }
        take(at);
        at = next;
      } else if (fits && skippable(at, end)) {
        if (data_[at + 2] == 'D') {
          ++unknown_ids_;
          ++log_.damage.records_lost;
        } else {
          ++unknown_types_;
        }
        at += 3 + size_at(at);
      } else {
        const std::size_t next = find_chain(at + 1, end, end, kSure);
        count_lost(at, next);
        at = next;
      }
    }
  }

  /// A message that means nothing to us, but after which sound ones follow.
  [[nodiscard]] bool skippable(std::size_t at, std::size_t end) const {
    if (at + 3 > end) return false;
    const auto type = static_cast<unsigned char>(data_[at + 2]);
    if (type <= ' ' || type > 126) return false;
    const std::size_t next = at + 3 + size_at(at);
    return next == end || (next < end && chain(next, end, 2));
  }

  void take(std::size_t at) {
    const std::string_view body = data_.substr(at + 3, size_at(at));
    switch (data_[at + 2]) {
      case 'D': {
        Subscription& subscription = subscriptions_[subscription_of_[load<std::uint16_t>(body.data())]];
        subscription.records.push_back(at + 5);
        subscription.sizes.push_back(static_cast<std::uint16_t>(body.size() - 2));
        data_begun_ = true;
        break;
      }
      case 'F': {
        const std::size_t colon = body.find(':');
        formats_.emplace(std::string(body.substr(0, colon)), std::string(body.substr(colon + 1)));
        break;
      }
      case 'A': {
        // Ids are counted up from 0; damage must not make thousands of topics.
        if (subscriptions_.size() >= 4096) break;
        Subscription subscription;
        subscription.instance = static_cast<unsigned char>(body[0]);
        subscription.name = std::string(body.substr(3, body.substr(3).find('\0')));
        subscription_of_[load<std::uint16_t>(body.data() + 1)] = static_cast<std::int32_t>(subscriptions_.size());
        subscriptions_.push_back(std::move(subscription));
        break;
      }
      case 'R':
        subscription_of_[load<std::uint16_t>(body.data())] = -1;
        break;
      case 'I':
        take_information(body, false, false);
        break;
      case 'M':
        take_information(body.substr(1), true, body[0] != 0);
        break;
      case 'P':
        take_parameter(body);
        break;
      case 'Q':
        take_default(body);
        break;
      case 'L':
        take_text(body, 1);
        break;
      case 'C':
        take_text(body, 3);
        break;
      case 'O':
        ++log_.damage.dropouts;
        log_.damage.dropout_s += 1e-3 * load<std::uint16_t>(body.data());
        break;
      default:
        break;
    }
  }

  void take_information(std::string_view body, bool multiple, bool continued) {
    const auto key = parse_key(body);
    if (!key) return;
    std::string text;
    if (key->type.rfind("char", 0) == 0) {
      text = internal::printable(key->value);
    } else if (const auto number = number_of(*key)) {
      text = fmt::format("{:.17g}", *number);
    } else {
      return;
    }
    std::string& value = log_.information[key->name];
    if (!multiple || value.empty()) {
      value = std::move(text);
    } else {
      if (!continued) value += '\n';
      value += text;
    }
  }

  void take_parameter(std::string_view body) {
    const auto key = parse_key(body);
    if (!key) return;
    const auto number = number_of(*key);
    if (!number) return;
    const auto found = log_.parameters.find(key->name);
    if (data_begun_ && found != log_.parameters.end() && found->second != *number) {
      log_.events.push_back({last_text_time_, "parameter", fmt::format("{} = {:.9g}", key->name, *number)});
    }
    log_.parameters[key->name] = *number;
  }

  void take_default(std::string_view body) {
    const auto key = parse_key(body.substr(1));
    if (!key) return;
    // Bit 0: default of the system, bit 1: of this airframe, which is the one that holds.
    const bool airframe = (static_cast<unsigned char>(body[0]) & 2U) != 0;
    const auto number = number_of(*key);
    if (number && (airframe || !log_.default_parameters.contains(key->name))) {
      log_.default_parameters[key->name] = *number;
    }
  }

  void take_text(std::string_view body, std::size_t stamp_at) {
    const double time = 1e-6 * static_cast<double>(load<std::uint64_t>(body.data() + stamp_at));
    last_text_time_ = time;
    log_.events.push_back({time, "message", internal::printable(body.substr(stamp_at + 8))});
  }

  std::string_view data_;
  Log& log_;
  std::vector<std::int32_t> subscription_of_;
  std::vector<Subscription> subscriptions_;
  ULogFormats formats_;
  bool data_begun_ = false;
  double last_text_time_ = 0.0;
  std::size_t unknown_ids_ = 0;
  std::size_t unknown_types_ = 0;
};

const ULogField* find_stamp(const ULogLayout& layout) {
  for (const ULogField& field : layout.fields) {
    if (field.name == "timestamp" && (field.type == GatherType::kUint64 || field.type == GatherType::kUint32)) {
      return &field;
    }
  }
  return nullptr;
}

/// The records of a subscription that are long enough; the others are counted.
std::vector<std::uint64_t> sound_records(Subscription& subscription, const ULogLayout& layout, Log& log) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < subscription.records.size(); ++i) {
    if (subscription.sizes[i] >= layout.size) subscription.records[kept++] = subscription.records[i];
  }
  if (const std::size_t lost = subscription.records.size() - kept; lost > 0) {
    log.damage.records_lost += lost;
    log.damage.notes.push_back(fmt::format("{} messages of {} are shorter than their format ({} bytes)", lost,
                                           internal::printable(subscription.name), layout.size));
  }
  subscription.records.resize(kept);
  return std::move(subscription.records);
}

LogTopic decode(std::string_view data, Subscription& subscription, const ULogLayout& layout, Log& log) {
  LogTopic topic;
  topic.name = internal::printable(subscription.name);
  topic.instance = subscription.instance;
  std::vector<std::uint64_t> records = sound_records(subscription, layout, log);
  const ULogField* const stamp = find_stamp(layout);
  if (stamp != nullptr) {
    std::vector<double> stamps(records.size());
    for (std::size_t i = 0; i < records.size(); ++i) {
      const char* const from = data.data() + records[i] + stamp->offset;
      stamps[i] = 1e-6 * (stamp->type == GatherType::kUint64 ? static_cast<double>(load<std::uint64_t>(from))
                                                             : static_cast<double>(load<std::uint32_t>(from)));
    }
    OrderedStamps ordered = order_stamps(std::move(stamps));
    if (!ordered.row.empty() || ordered.time.empty()) {
      std::vector<std::uint64_t> chosen;
      chosen.reserve(ordered.row.size());
      for (const std::uint64_t row : ordered.row) chosen.push_back(records[row]);
      records = std::move(chosen);
    }
    topic.spikes = ordered.spikes;
    topic.reordered = ordered.reordered;
    topic.doubled = ordered.doubled;
    topic.time = make_time_base(std::move(ordered.time));
  } else {
    topic.schema = true;
    log.damage.notes.push_back(fmt::format("{} has no timestamp and makes no channels", topic.name));
  }
  std::vector<GatherColumn> selected;
  for (const ULogField& from : layout.fields) {
    if (&from == stamp) continue;
    const Px4Unit known = px4_unit(topic.name, from.base_name);
    LogField field;
    field.name = internal::printable(from.name);
    field.unit = known.unit;
    field.scale = known.scale;
    topic.fields.push_back(std::move(field));
    selected.push_back({from.type, from.offset, from.size});
  }
  std::vector<Column> columns = gather(data.data(), records, selected);
  for (std::size_t i = 0; i < columns.size(); ++i) topic.fields[i].values = std::move(columns[i]);
  return topic;
}

// nav_state and arming_state of PX4's vehicle_status.msg.
void read_ulog_events(Log& log) {
  static const std::map<int, const char*> modes{{0, "MANUAL"},         {1, "ALTCTL"},      {2, "POSCTL"},
                                                {3, "AUTO_MISSION"},   {4, "AUTO_LOITER"}, {5, "AUTO_RTL"},
                                                {10, "ACRO"},          {12, "DESCEND"},    {13, "TERMINATION"},
                                                {14, "OFFBOARD"},      {15, "STABILIZED"}, {16, "RATTITUDE"},
                                                {17, "AUTO_TAKEOFF"},  {18, "AUTO_LAND"},  {19, "AUTO_FOLLOW_TARGET"},
                                                {20, "AUTO_PRECLAND"}, {21, "ORBIT"},      {22, "AUTO_VTOL_TAKEOFF"}};
  const LogTopic* status = log.find("vehicle_status");
  if (status == nullptr || !status->time) return;
  const LogField* mode = status->find("nav_state");
  const LogField* arming = status->find("arming_state");
  double last_mode = -1.0;
  int last_armed = -1;
  for (std::size_t i = 0; i < status->size(); ++i) {
    const double time = (*status->time)[i];
    if (mode != nullptr && !mode->values.is_text() && mode->value(i) != last_mode) {
      last_mode = mode->value(i);
      const auto found = modes.find(static_cast<int>(std::clamp(last_mode, -1.0, 1e6)));
      log.events.push_back({time, "mode", found == modes.end() ? fmt::format("{:.0f}", last_mode) : found->second});
    }
    if (arming != nullptr && !arming->values.is_text()) {
      const int armed = arming->value(i) == 2.0 ? 1 : 0;
      if (armed != last_armed) log.events.push_back({time, "armed", armed == 1 ? "armed" : "disarmed"});
      last_armed = armed;
    }
  }
}

}  // namespace

bool is_ulog(std::string_view bytes) { return bytes.substr(0, kULogMagic.size()) == kULogMagic; }

Log read_ulog(std::string_view bytes, std::string source) {
  Log log;
  log.source = std::move(source);
  log.format = "PX4 ULog";
  if (bytes.empty()) throw InputError(log.source, "the file is empty");
  if (!is_ulog(bytes)) throw InputError(log.source, "not a PX4 ULog: it does not start with 55 4C 6F 67 01 12 35");
  if (bytes.size() < kHeader) {
    throw InputError(log.source, fmt::format("the ULog ends inside its header ({} of 16 bytes)", bytes.size()));
  }
  Walker walker(bytes, log);
  walker.run();
  std::map<std::string, std::optional<ULogLayout>, std::less<>> layouts;
  std::set<std::string> undefined;
  for (Subscription& subscription : walker.subscriptions()) {
    auto layout = layouts.find(subscription.name);
    if (layout == layouts.end()) {
      layout = layouts.emplace(subscription.name, resolve_ulog_format(walker.formats(), subscription.name)).first;
    }
    if (!layout->second) {
      if (subscription.records.empty()) continue;
      log.damage.records_lost += subscription.records.size();
      undefined.insert(internal::printable(subscription.name));
      continue;
    }
    if (!subscription.records.empty()) log.topics.push_back(decode(bytes, subscription, *layout->second, log));
  }
  if (!undefined.empty()) {
    log.damage.notes.push_back(fmt::format("topics without a usable format: {}", fmt::join(undefined, ", ")));
  }
  read_ulog_events(log);
  internal::finish(log);
  return log;
}

Log read_ulog_file(const std::filesystem::path& path) {
  const MappedFile file(path);
  return read_ulog(file.bytes(), path.string());
}

}  // namespace veridyn::io
