#include "veridyn/io/mavlink/tlog.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/log/time_stamps.hpp"
#include "veridyn/io/mavlink/mavlink_messages.hpp"
#include "veridyn/io/mavlink/mavlink_packet.hpp"
#include "veridyn/io/mavlink/tlog_clock.hpp"

namespace veridyn::io {
namespace {

constexpr std::size_t kStamp = 8;
/// 1990 and 2100 [us since 1970].
constexpr std::uint64_t kEarliest_us = 631'152'000'000'000, kLatest_us = 4'102'444'800'000'000;
/// Neighbours in a row by which a log is recognised.
constexpr int kSure = 3;
constexpr std::uint32_t kHeartbeat = 0, kParameter = 22, kText = 253;
/// MAV_MODE_FLAG_SAFETY_ARMED, MAV_AUTOPILOT_INVALID.
constexpr unsigned kArmed = 128, kNoAutopilot = 8;

std::uint64_t big_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < kStamp; ++i) value = value << 8U | static_cast<unsigned char>(bytes[i]);
  return value;
}

bool is_stamp(std::uint64_t us) { return us > kEarliest_us && us < kLatest_us; }

/// A packet and when it was received.
struct Received {
  MavlinkPacket packet;
  std::uint64_t us = 0;
};

/// What stands here; nothing where no plausible stamp is before a packet.
std::optional<Received> record_at(std::string_view bytes) {
  if (bytes.size() < kStamp) return std::nullopt;
  const std::uint64_t us = big_endian(bytes);
  if (!is_stamp(us)) return std::nullopt;
  const std::optional<MavlinkPacket> packet = mavlink_packet(bytes.substr(kStamp));
  if (!packet) return std::nullopt;
  return Received{*packet, us};
}

/// Who sends: a component of a system.
struct Sender {
  std::uint8_t system = 0, component = 0;
  friend bool operator==(const Sender&, const Sender&) = default;
  friend bool operator<(const Sender& a, const Sender& b) {
    return std::tie(a.system, a.component) < std::tie(b.system, b.component);
  }
};

/// All packets of one message of one sender, their payloads one after the other, each with all of its bytes.
struct Stream {
  const MavlinkMessage* message = nullptr;
  std::string payloads;
  std::vector<std::size_t> number;  ///< of each, in its sender's packets
};

/// All that one sender sent.
struct Sent {
  std::map<std::uint32_t, Stream> streams;  ///< by message
  internal::SenderClock clock;
  std::size_t packets = 0, motion = 0;
};

std::optional<double> own_stamp(const MavlinkMessage& message, const char* payload) {
  const MavlinkField& first = message.fields.front();
  if (first.name == "time_boot_ms") {
    std::uint32_t ms = 0;
    std::memcpy(&ms, payload + first.offset, sizeof ms);
    return ms == 0 ? std::nullopt : std::optional(1e-3 * ms);
  }
  if (first.name != "time_usec") return std::nullopt;
  std::uint64_t us = 0;
  std::memcpy(&us, payload + first.offset, first.element_size());
  // 0: not known.
  return us == 0 ? std::nullopt : std::optional(1e-6 * static_cast<double>(us));
}

bool is_stamp_field(const MavlinkField& field) { return field.name == "time_boot_ms" || field.name == "time_usec"; }

/// Messages by which the system that the log is about is found.
bool is_motion(std::uint32_t message) {
  constexpr std::array<std::uint32_t, 8> kMotion{26, 27, 30, 31, 32, 33, 36, 105};
  return std::ranges::find(kMotion, message) != kMotion.end();
}

/// View of the bytes of a log, walked from packet to packet.
class TlogReader {
 public:
  TlogReader(std::string_view bytes, Log& log) : bytes_(bytes), log_(log) {}

  void run() {
    walk();
    finish_damage();
    const Sender main = main_sender();
    for (auto& [sender, sent] : senders_) {
      const std::vector<double> times = sent.clock.times();
      for (const auto& [id, stream] : sent.streams) {
        add_story(sender, main, stream, times);
        if (id != kParameter && id != kText) add_topics(name_of(sender, main, stream), stream, times);
      }
      if (sender == main) log_.restarts = sent.clock.restarts();
    }
    if (const std::size_t count = log_.restarts.size(); count > 0)
      log_.damage.notes.push_back(fmt::format("the vehicle restarted {} time{}; its times go on after what came before",
                                              count, count == 1 ? "" : "s"));
  }

 private:
  void walk() {
    std::size_t at = 0;
    while (at < bytes_.size()) {
      const std::optional<Received> record = record_at(bytes_.substr(at));
      if (!record || !trusted(*record, at)) {
        const std::size_t next = next_sound(at + 1);
        log_.damage.bytes_lost += next - at;
        ++log_.damage.records_lost;
        if (record && record->packet.sound == false) ++wrong_checksums_;
        at = next;
        continue;
      }
      take(*record);
      at += kStamp + record->packet.size;
    }
  }

  /// A packet whose checksum cannot be checked leads on only where the log goes on behind it.
  [[nodiscard]] bool trusted(const Received& record, std::size_t at) const {
    if (record.packet.sound) return *record.packet.sound;
    const std::size_t next = at + kStamp + record.packet.size;
    return next == bytes_.size() || record_at(bytes_.substr(next)).has_value();
  }

  /// Where the next packet with a right checksum begins, or the log ends.
  [[nodiscard]] std::size_t next_sound(std::size_t from) const {
    for (std::size_t at = from; at < bytes_.size(); ++at) {
      // Stamps of this century begin with 00 0x.
      if (bytes_[at] != '\0') continue;
      const std::optional<Received> record = record_at(bytes_.substr(at));
      if (record && record->packet.sound == true) return at;
    }
    return bytes_.size();
  }

  void take(const Received& record) {
    const MavlinkPacket& packet = record.packet;
    if (!first_us_) first_us_ = record.us;
    const MavlinkMessage* const message = packet.sound ? find_mavlink_message(packet.message) : nullptr;
    if (message == nullptr) {
      ++unread_[packet.message];
      return;
    }
    Sent& sent = sent_by({packet.system, packet.component});
    Stream& stream = sent.streams[packet.message];
    stream.message = message;
    const std::size_t begin = stream.payloads.size();
    stream.payloads.append(packet.payload.substr(0, message->size));
    stream.payloads.resize(begin + message->size, '\0');
    stream.number.push_back(sent.packets++);
    sent.motion += is_motion(packet.message) ? 1 : 0;
    sent.clock.add(1e-6 * (static_cast<double>(record.us) - static_cast<double>(*first_us_)),
                   own_stamp(*message, stream.payloads.data() + begin));
  }

  Sent& sent_by(const Sender& sender) {
    if (last_.second == nullptr || last_.first != sender) last_ = {sender, &senders_[sender]};
    return *last_.second;
  }

  void finish_damage() {
    if (wrong_checksums_ > 0)
      log_.damage.notes.push_back(fmt::format("{} packets with a wrong checksum", wrong_checksums_));
    if (unread_.empty()) return;
    std::size_t packets = 0;
    std::string ids;
    std::size_t listed = 0;
    for (const auto& [id, count] : unread_) {
      packets += count;
      if (listed++ < 12) ids += fmt::format("{}{}", ids.empty() ? "" : ", ", id);
    }
    log_.information["messages not read"] =
        fmt::format("{} packets of {} kinds (ids {}{})", packets, unread_.size(), ids, listed > 12 ? ", ..." : "");
  }

  /// Who sent most of the motion; without any, most packets.
  [[nodiscard]] Sender main_sender() const {
    Sender best;
    std::pair<std::size_t, std::size_t> most{0, 0};
    for (const auto& [sender, sent] : senders_) {
      const std::pair<std::size_t, std::size_t> has{sent.motion, sent.packets};
      if (has > most) {
        most = has;
        best = sender;
      }
    }
    return best;
  }

  static std::string name_of(const Sender& sender, const Sender& main, const Stream& stream) {
    std::string name;
    if (sender.system != main.system) name = fmt::format("system{}.", sender.system);
    const bool usual = sender.system == main.system ? sender.component == main.component : sender.component == 1;
    if (!usual) name += fmt::format("component{}.", sender.component);
    return name + std::string(stream.message->name);
  }

  /// Parameters, arming and texts.
  void add_story(const Sender& sender, const Sender& main, const Stream& stream, const std::vector<double>& times) {
    const MavlinkMessage& message = *stream.message;
    const bool ours = sender.system == main.system;
    int armed = -1;
    for (std::size_t i = 0; i < stream.number.size(); ++i) {
      const char* const payload = stream.payloads.data() + i * message.size;
      const double time = times[stream.number[i]];
      const auto text = [&](const char* name) {
        const MavlinkField& field = *message.find(name);
        const std::string_view all(payload + field.offset, field.count);
        return internal::printable(all.substr(0, all.find('\0')));
      };
      if (message.id == kParameter && ours) {
        float value = 0.0F;
        std::memcpy(&value, payload + message.find("param_value")->offset, sizeof value);
        log_.parameters[text("param_id")] = static_cast<double>(value);
      } else if (message.id == kText) {
        log_.events.push_back(
            {time, "message", ours ? text("text") : fmt::format("system {}: {}", sender.system, text("text"))});
      } else if (message.id == kHeartbeat && sender == main) {
        const auto byte = [&](const char* name) {
          return static_cast<unsigned>(static_cast<unsigned char>(payload[message.find(name)->offset]));
        };
        if (byte("autopilot") == kNoAutopilot) continue;
        log_.information["autopilot"] = autopilot_name(byte("autopilot"));
        if (const char* const vehicle = vehicle_name(byte("type"))) log_.information["vehicle"] = vehicle;
        const int now = (byte("base_mode") & kArmed) != 0 ? 1 : 0;
        if (now != armed) log_.events.push_back({time, "armed", now == 1 ? "armed" : "disarmed"});
        armed = now;
      }
    }
  }

  static std::string autopilot_name(unsigned autopilot) {
    return autopilot == 3 ? "ArduPilot" : autopilot == 12 ? "PX4" : fmt::format("MAV_AUTOPILOT {}", autopilot);
  }

  /// Of MAV_TYPE what matters here; null for others.
  static const char* vehicle_name(unsigned type) {
    constexpr unsigned kFixedWing = 1, kGroundRover = 10, kBoat = 11;
    return type == kFixedWing ? "fixed wing" : type == kGroundRover ? "ground rover" : type == kBoat ? "boat" : nullptr;
  }

  /// One topic for each instance.
  void add_topics(const std::string& name, const Stream& stream, const std::vector<double>& times) {
    const MavlinkMessage& message = *stream.message;
    const MavlinkField* const numbered = message.instance.empty() ? nullptr : message.find(message.instance);
    std::map<unsigned char, std::vector<std::uint64_t>> instances;
    for (std::size_t i = 0; i < stream.number.size(); ++i)
      instances[numbered == nullptr ? 0
                                    : static_cast<unsigned char>(stream.payloads[i * message.size + numbered->offset])]
          .push_back(i);
    for (const auto& [instance, rows] : instances) add_topic(name, instance, rows, stream, times);
  }

  void add_topic(const std::string& name, int instance, const std::vector<std::uint64_t>& rows, const Stream& stream,
                 const std::vector<double>& times) {
    const MavlinkMessage& message = *stream.message;
    LogTopic topic;
    topic.name = name;
    topic.instance = instance;
    std::vector<double> stamps;
    for (const std::uint64_t row : rows) stamps.push_back(times[stream.number[row]]);
    OrderedStamps ordered = order_stamps(std::move(stamps));
    std::vector<std::uint64_t> places;
    for (std::size_t i = 0; i < ordered.time.size(); ++i)
      places.push_back(rows[ordered.row.empty() ? i : ordered.row[i]] * message.size);
    topic.spikes = ordered.spikes;
    topic.reordered = ordered.reordered;
    topic.doubled = ordered.doubled;
    topic.time = make_time_base(std::move(ordered.time));
    std::vector<GatherColumn> columns;
    std::vector<bool> all_ones, extensions;
    for (const MavlinkField& from : message.fields) {
      if (is_stamp_field(from) || from.name == message.instance) continue;
      for (std::uint32_t i = 0; i < from.count; ++i) {
        LogField field;
        field.name = from.count == 1 ? std::string(from.name) : fmt::format("{}[{}]", from.name, i);
        field.unit = from.unit;
        field.scale = from.scale;
        topic.fields.push_back(std::move(field));
        columns.push_back({from.type, from.offset + i * from.element_size(), from.element_size()});
        all_ones.push_back(from.none_is_all_ones);
        extensions.push_back(from.extension);
      }
    }
    std::vector<Column> values = gather(stream.payloads.data(), places, columns);
    for (std::size_t i = 0; i < values.size(); ++i)
      topic.fields[i].values = all_ones[i] ? without_all_ones(std::move(values[i])) : std::move(values[i]);
    // An extension of zeros throughout was not sent: packets end before it.
    std::size_t i = 0;
    std::erase_if(topic.fields, [&](const LogField& field) { return extensions[i++] && all_zero(field.values); });
    log_.topics.push_back(std::move(topic));
  }

  static bool all_zero(const Column& column) {
    for (std::size_t i = 0; i < column.size(); ++i)
      if (column.number(i) != 0.0) return false;
    return true;
  }

  /// NaN where all bits are set.
  static Column without_all_ones(Column column) {
    return std::visit(
        [&](auto& values) -> Column {
          using Number = typename std::decay_t<decltype(values)>;
          if constexpr (std::is_same_v<Number, std::vector<std::uint16_t>> ||
                        std::is_same_v<Number, std::vector<std::uint8_t>>) {
            constexpr auto kNone = static_cast<typename Number::value_type>(~0U);
            if (std::ranges::find(values, kNone) == values.end()) return std::move(column);
            std::vector<double> numbers;
            for (const auto v : values) numbers.push_back(v == kNone ? kNaN : static_cast<double>(v));
            return Column(std::move(numbers));
          } else {
            return std::move(column);
          }
        },
        column.storage());
  }

  std::string_view bytes_;
  Log& log_;
  std::map<Sender, Sent> senders_;
  std::pair<Sender, Sent*> last_{};  ///< who sent the last packet
  std::map<std::uint32_t, std::size_t> unread_;
  std::optional<std::uint64_t> first_us_;
  std::size_t wrong_checksums_ = 0;
};

}  // namespace

bool is_tlog(std::string_view bytes) {
  bool checked = false;
  for (int i = 0; i < kSure; ++i) {
    if (bytes.empty()) return checked;
    const std::optional<Received> record = record_at(bytes);
    if (!record) return false;
    checked = checked || record->packet.sound == true;
    bytes.remove_prefix(kStamp + record->packet.size);
  }
  return true;
}

Log read_tlog(std::string_view bytes, std::string source) {
  Log log;
  log.source = std::move(source);
  log.format = "MAVLink telemetry log";
  if (bytes.empty()) throw InputError(log.source, "the file is empty");
  if (!is_tlog(bytes))
    throw InputError(log.source, "not a telemetry log of MAVLink: no stamp of this century before a packet");
  TlogReader(bytes, log).run();
  log.frame = Frame::kFrd;
  internal::finish(log);
  return log;
}

}  // namespace veridyn::io
