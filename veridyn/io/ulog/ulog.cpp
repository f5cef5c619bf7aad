#include "veridyn/io/ulog/ulog.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <utility>

#include "veridyn/core/bytes.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/log/clock_restarts.hpp"
#include "veridyn/io/log/time_stamps.hpp"
#include "veridyn/io/ulog/px4_units.hpp"
#include "veridyn/io/ulog/ulog_format.hpp"
#include "veridyn/io/ulog/ulog_story.hpp"

namespace veridyn::io {
namespace {

constexpr std::string_view kULogMagic{"\x55\x4C\x6F\x67\x01\x12\x35", 7};
constexpr std::string_view kSync{"\x2F\x73\x13\x20\x25\x0C\xBB\x12", 8};
constexpr std::size_t kHeader = 16;
constexpr std::size_t kIds = 65536;

struct Subscription {
  std::string name;
  int instance = 0;
  std::size_t session = 0;
  std::vector<std::uint64_t> records;  ///< where the data begin, after the id
  std::vector<std::uint16_t> sizes;    ///< bytes of data
  std::optional<ULogField> stamp;      ///< once its format is known
  std::size_t formats_tried = 0;       ///< how many formats were known when it was looked for
};

const ULogField* find_stamp(const ULogLayout& layout) {
  for (const ULogField& field : layout.fields) {
    if (field.name == "timestamp" && (field.type == GatherType::kUint64 || field.type == GatherType::kUint32)) {
      return &field;
    }
  }
  return nullptr;
}

/// In seconds.
double load_stamp(const char* data, const ULogField& stamp) {
  const char* const from = data + stamp.offset;
  return 1e-6 * (stamp.type == GatherType::kUint64 ? static_cast<double>(load_number<std::uint64_t>(from))
                                                   : static_cast<double>(load_number<std::uint32_t>(from)));
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
    restarts_.finish();
    for (std::size_t i = 0; i < log_.events.size(); ++i) log_.events[i].time += restarts_.shift_at(event_places_[i]);
    if (unknown_ids_ > 0) {
      log_.damage.notes.push_back(fmt::format("{} data messages of ids without a subscription", unknown_ids_));
    }
    if (unknown_types_ > 0) log_.damage.notes.push_back(fmt::format("{} messages of unknown type", unknown_types_));
  }

  std::vector<Subscription>& subscriptions() { return subscriptions_; }
  /// Of each session: a log that follows another one in the file has its own.
  [[nodiscard]] const std::vector<ULogFormats>& formats() const { return formats_; }
  [[nodiscard]] const ClockRestarts& restarts() const { return restarts_; }

 private:
  /// Ends of the stretches of messages: data appended after a crash start at the offsets in the flag message, wherever
  /// the message before them was cut.
  std::vector<std::size_t> segments() {
    std::vector<std::size_t> ends;
    if (data_.size() >= kHeader + 43 && data_[kHeader + 2] == 'B' &&
        load_number<std::uint16_t>(data_.data() + kHeader) >= 40) {
      const char* const flags = data_.data() + kHeader + 3;
      const auto incompatible = load_number<std::uint64_t>(flags + 8);
      if ((incompatible & ~std::uint64_t{1}) != 0) {
        throw InputError(log_.source, fmt::format("this ULog needs features that this reader does not know "
                                                  "(incompatible flag bits {:#x})",
                                                  incompatible & ~std::uint64_t{1}));
      }
      if ((incompatible & 1U) != 0) {
        for (int i = 0; i < 3; ++i) {
          const auto offset = load_number<std::uint64_t>(flags + 16 + 8 * i);
          if (offset > kHeader + 43 && offset < data_.size()) ends.push_back(static_cast<std::size_t>(offset));
        }
        std::sort(ends.begin(), ends.end());
      }
    }
    ends.push_back(data_.size());
    return ends;
  }

  [[nodiscard]] std::size_t size_at(std::size_t at) const { return load_number<std::uint16_t>(data_.data() + at); }
  /// Whether another log begins here.
  [[nodiscard]] bool is_header(std::size_t at, std::size_t end) const {
    return at + kHeader <= end && data_.substr(at, kULogMagic.size()) == kULogMagic;
  }
  /// Where what begins here ends: a message or a header.
  [[nodiscard]] std::size_t next_of(std::size_t at, std::size_t end) const {
    return at + (is_header(at, end) ? kHeader : 3 + size_at(at));
  }

  /// Whether a message of a known type that makes sense by itself, or a header, stands here.
  [[nodiscard]] bool plausible(std::size_t at, std::size_t end) const {
    if (at + 3 > end) return false;
    if (is_header(at, end)) return true;
    const std::size_t size = size_at(at);
    if (size == 0 || at + 3 + size > end) return false;
    const char* const body = data_.data() + at + 3;
    switch (data_[at + 2]) {
      case 'D':
        return size > 2 && subscription_of_[load_number<std::uint16_t>(body)] >= 0;
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
        return is_header(at - kHeader, end) && size >= 40;
      default:
        return false;
    }
  }

  [[nodiscard]] bool chain(std::size_t at, std::size_t end, int length) const {
    for (int i = 0; i < length; ++i) {
      if (at == end && i > 0) return true;
      if (!plausible(at, end)) return false;
      at = next_of(at, end);
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
      if (is_header(at, end)) {
        formats_.emplace_back();
        data_begun_ = false;
        at += kHeader;
      } else if (plausible(at, end)) {
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
        Subscription& subscription = subscriptions_[subscription_of_[load_number<std::uint16_t>(body.data())]];
        subscription.records.push_back(at + 5);
        subscription.sizes.push_back(static_cast<std::uint16_t>(body.size() - 2));
        data_begun_ = true;
        tick(subscription, body.substr(2), at);
        break;
      }
      case 'F': {
        const std::size_t colon = body.find(':');
        formats_.back().emplace(std::string(body.substr(0, colon)), std::string(body.substr(colon + 1)));
        break;
      }
      case 'A': {
        // Ids are counted up from 0; damage must not make thousands of topics.
        if (subscriptions_.size() >= 4096) break;
        Subscription subscription;
        subscription.session = formats_.size() - 1;
        subscription.instance = static_cast<unsigned char>(body[0]);
        subscription.name = std::string(body.substr(3, body.substr(3).find('\0')));
        subscription_of_[load_number<std::uint16_t>(body.data() + 1)] =
            static_cast<std::int32_t>(subscriptions_.size());
        subscriptions_.push_back(std::move(subscription));
        break;
      }
      case 'R':
        subscription_of_[load_number<std::uint16_t>(body.data())] = -1;
        break;
      case 'I':
        take_information(body, false, false);
        break;
      case 'M':
        take_information(body.substr(1), true, body[0] != 0);
        break;
      case 'P':
        take_parameter(body, at);
        break;
      case 'Q':
        take_default(body);
        break;
      case 'L':
        take_text(body, 1, at);
        break;
      case 'C':
        take_text(body, 3, at);
        break;
      case 'O':
        ++log_.damage.dropouts;
        log_.damage.dropout_s += 1e-3 * load_number<std::uint16_t>(body.data());
        break;
      default:
        break;
    }
  }

  /// Follows the clock of the log.
  void tick(Subscription& subscription, std::string_view data, std::size_t at) {
    const ULogFormats& formats = formats_[subscription.session];
    // Formats may stand after the data.
    if (!subscription.stamp && subscription.formats_tried != formats.size()) {
      subscription.formats_tried = formats.size();
      const auto layout = resolve_ulog_format(formats, subscription.name);
      const ULogField* const stamp = layout ? find_stamp(*layout) : nullptr;
      if (stamp != nullptr) subscription.stamp = *stamp;
    }
    if (!subscription.stamp || data.size() < subscription.stamp->offset + subscription.stamp->size) return;
    restarts_.add(load_stamp(data.data(), *subscription.stamp), at);
  }

  void take_event(Event event, std::size_t at) {
    log_.events.push_back(std::move(event));
    event_places_.push_back(at);
  }

  void take_information(std::string_view body, bool multiple, bool continued) {
    const auto key = parse_ulog_key(body);
    if (!key) return;
    std::string text;
    if (key->type.rfind("char", 0) == 0) {
      text = internal::printable(key->value);
    } else if (const auto number = ulog_number(*key)) {
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

  void take_parameter(std::string_view body, std::size_t at) {
    const auto key = parse_ulog_key(body);
    if (!key) return;
    const auto number = ulog_number(*key);
    if (!number) return;
    const auto found = log_.parameters.find(key->name);
    if (data_begun_ && found != log_.parameters.end() && found->second != *number) {
      take_event({last_text_time_, "parameter", fmt::format("{} = {:.9g}", key->name, *number)}, at);
    }
    log_.parameters[key->name] = *number;
  }

  void take_default(std::string_view body) {
    const auto key = parse_ulog_key(body.substr(1));
    if (!key) return;
    // Bit 0: default of the system, bit 1: of this airframe, which is the one that holds.
    const bool airframe = (static_cast<unsigned char>(body[0]) & 2U) != 0;
    const auto number = ulog_number(*key);
    if (number && (airframe || !log_.default_parameters.contains(key->name))) {
      log_.default_parameters[key->name] = *number;
    }
  }

  void take_text(std::string_view body, std::size_t stamp_at, std::size_t at) {
    const double time = 1e-6 * static_cast<double>(load_number<std::uint64_t>(body.data() + stamp_at));
    last_text_time_ = time;
    restarts_.add(time, at);
    take_event({time, "message", internal::printable(body.substr(stamp_at + 8))}, at);
  }

  std::string_view data_;
  Log& log_;
  std::vector<std::int32_t> subscription_of_;
  std::vector<Subscription> subscriptions_;
  std::vector<ULogFormats> formats_{1};
  ClockRestarts restarts_;
  std::vector<std::uint64_t> event_places_;  // where the events stand
  bool data_begun_ = false;
  double last_text_time_ = 0.0;
  std::size_t unknown_ids_ = 0;
  std::size_t unknown_types_ = 0;
};

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

LogTopic decode(std::string_view data, Subscription& subscription, const ULogLayout& layout,
                const ClockRestarts& restarts, Log& log) {
  LogTopic topic;
  topic.name = internal::printable(subscription.name);
  topic.instance = subscription.instance;
  std::vector<std::uint64_t> records = sound_records(subscription, layout, log);
  const ULogField* const stamp = find_stamp(layout);
  if (stamp != nullptr) {
    std::vector<double> stamps(records.size());
    for (std::size_t i = 0; i < records.size(); ++i) stamps[i] = load_stamp(data.data() + records[i], *stamp);
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

/// Of each topic in each session; nothing where it is not defined.
using Layouts = std::map<std::pair<std::size_t, std::string>, std::optional<ULogLayout>>;

Layouts layouts_of(Walker& walker) {
  Layouts layouts;
  for (const Subscription& s : walker.subscriptions()) {
    const auto [place, added] = layouts.try_emplace({s.session, s.name});
    if (added) place->second = resolve_ulog_format(walker.formats()[s.session], s.name);
  }
  return layouts;
}

/// Makes one topic of those that several logs in one file have alike.
void join_sessions(std::vector<Subscription>& subscriptions, const Layouts& layouts) {
  std::map<std::pair<std::string, int>, Subscription*> first;
  for (Subscription& s : subscriptions) {
    const auto [place, added] = first.try_emplace({s.name, s.instance}, &s);
    Subscription& before = *place->second;
    if (added || before.session == s.session) continue;
    if (layouts.at({before.session, s.name}) != layouts.at({s.session, s.name})) continue;
    before.records.insert(before.records.end(), s.records.begin(), s.records.end());
    before.sizes.insert(before.sizes.end(), s.sizes.begin(), s.sizes.end());
    s.records.clear();
    s.sizes.clear();
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
  const Layouts layouts = layouts_of(walker);
  join_sessions(walker.subscriptions(), layouts);
  std::set<std::string> undefined;
  for (Subscription& subscription : walker.subscriptions()) {
    if (subscription.records.empty()) continue;
    const std::optional<ULogLayout>& layout = layouts.at({subscription.session, subscription.name});
    if (!layout) {
      log.damage.records_lost += subscription.records.size();
      undefined.insert(internal::printable(subscription.name));
      continue;
    }
    log.topics.push_back(decode(bytes, subscription, *layout, walker.restarts(), log));
  }
  if (!undefined.empty()) {
    log.damage.notes.push_back(fmt::format("topics without a usable format: {}", fmt::join(undefined, ", ")));
  }
  read_ulog_events(log);
  walker.restarts().report_to(log);
  internal::finish(log);
  return log;
}

}  // namespace veridyn::io
