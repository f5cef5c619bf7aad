#include "veridyn/io/ros/mcap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include "veridyn/core/bytes.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/packets/crc32.hpp"
#include "veridyn/io/ros/mcap_chunk.hpp"
#include "veridyn/io/ros/ros_log.hpp"

namespace veridyn::io {
namespace internal {
namespace {

constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";
/// Opcode and length before each record.
constexpr std::size_t kRecordHeader = 9;

enum Opcode : unsigned char {
  kHeaderRecord = 1,
  kFooterRecord = 2,
  kSchemaRecord = 3,
  kChannelRecord = 4,
  kMessageRecord = 5,
  kChunkRecord = 6,
  kMessageIndexRecord = 7,
  kStatisticsRecord = 11,
  kDataEndRecord = 15,
  kLastRecord = 15,
};

constexpr std::size_t kFooterSize = 20, kMessageSize = 22, kChunkSize = 40;

class McapReader {
 public:
  McapReader(std::string_view bytes, RosLog& messages, Log& log) : bytes_(bytes), messages_(messages), log_(log) {}

  void run() {
    const std::uint64_t before = messages_.messages();
    std::string_view records = bytes_.substr(kMcapMagic.size());
    const bool finished = records.ends_with(kMcapMagic);
    if (finished) {
      records.remove_suffix(kMcapMagic.size());
      read_summary(records);
    }
    walk(records, false);
    if (!finished)
      log_.damage.notes.emplace_back("it ends without a footer: its recorder was stopped, or the file is cut off");
    if (wrong_checksums_ > 0)
      log_.damage.notes.push_back(fmt::format("{} chunks with a wrong checksum", wrong_checksums_));
    if (not_unpacked_ > 0)
      log_.damage.notes.push_back(fmt::format("{} chunks that cannot be unpacked{}", not_unpacked_, reason_));
    if (unknown_channels_ > 0)
      log_.damage.notes.push_back(fmt::format("{} messages of channels that are not described", unknown_channels_));
    const std::uint64_t found = messages_.messages() - before + unknown_channels_;
    if (counted_ && *counted_ > found) {
      log_.damage.records_lost = std::max(log_.damage.records_lost, *counted_ - found);
      log_.damage.notes.push_back(
          fmt::format("{} messages of {} that its summary counts are missing", *counted_ - found, *counted_));
    }
  }

 private:
  struct Schema {
    std::string name, encoding, data;
  };
  static constexpr std::size_t kUnknown = SIZE_MAX - 1;

  /// Schemas and channels stand there again: should those among the data be damaged.
  void read_summary(std::string_view records) {
    if (records.size() < kRecordHeader + kFooterSize) return;
    const std::size_t footer = records.size() - kRecordHeader - kFooterSize;
    if (static_cast<unsigned char>(records[footer]) != kFooterRecord ||
        load_number<std::uint64_t>(records.data() + footer + 1) != kFooterSize)
      return;
    ByteReader fields(records.substr(footer + kRecordHeader));
    const auto start = fields.number<std::uint64_t>();
    (void)fields.number<std::uint64_t>();
    const auto crc = fields.number<std::uint32_t>();
    if (start < kMcapMagic.size() || start - kMcapMagic.size() >= footer) return;
    const std::size_t begin = start - kMcapMagic.size();
    if (crc != 0 && crc32(records.substr(begin, records.size() - 4 - begin)) != crc) return;
    std::string_view summary = records.substr(begin, footer - begin);
    while (summary.size() >= kRecordHeader) {
      const auto op = static_cast<unsigned char>(summary.front());
      const auto size = load_number<std::uint64_t>(summary.data() + 1);
      if (size > summary.size() - kRecordHeader) return;
      const std::string_view body = summary.substr(kRecordHeader, size);
      if (op == kSchemaRecord) take_schema(body);
      if (op == kChannelRecord) take_channel(body);
      if (op == kStatisticsRecord && crc != 0 && body.size() >= 8) counted_ = load_number<std::uint64_t>(body.data());
      summary.remove_prefix(kRecordHeader + size);
    }
  }

  [[nodiscard]] static bool fits(std::string_view records, std::size_t at) {
    return records.size() - at >= kRecordHeader &&
           load_number<std::uint64_t>(records.data() + at + 1) <= records.size() - at - kRecordHeader;
  }

  /// Whether a record of a known kind that makes sense by itself stands here.
  [[nodiscard]] bool plausible(std::string_view records, std::size_t at, bool in_chunk) const {
    if (!fits(records, at)) return false;
    const auto size = load_number<std::uint64_t>(records.data() + at + 1);
    const char* const body = records.data() + at + kRecordHeader;
    switch (static_cast<unsigned char>(records[at])) {
      case kMessageRecord:
        return size >= kMessageSize;
      case kSchemaRecord:
        return size >= 14;
      case kChannelRecord:
        return size >= 16;
      case kChunkRecord:
        return !in_chunk && size >= kChunkSize && load_number<std::uint32_t>(body + 28) <= size - kChunkSize;
      case kHeaderRecord:
        return !in_chunk && size >= 8;
      case kFooterRecord:
        return !in_chunk && size == kFooterSize;
      case kMessageIndexRecord:
        return !in_chunk && size >= 6;
      case kDataEndRecord:
        return !in_chunk && size >= 4;
      default:
        return !in_chunk && records[at] != 0;
    }
  }

  /// Whether a record stands here after which another follows, or nothing more.
  [[nodiscard]] bool chained(std::string_view records, std::size_t at, bool in_chunk) const {
    const auto op = static_cast<unsigned char>(records[at]);
    if (op == 0 || op > kLastRecord || !plausible(records, at, in_chunk)) return false;
    const std::size_t next = at + kRecordHeader + load_number<std::uint64_t>(records.data() + at + 1);
    if (next == records.size()) return true;
    const auto next_op = static_cast<unsigned char>(records[next]);
    return next_op <= kLastRecord && plausible(records, next, in_chunk);
  }

  void walk(std::string_view records, bool in_chunk) {
    std::size_t at = 0;
    while (at < records.size()) {
      if (plausible(records, at, in_chunk)) {
        const std::size_t size = load_number<std::uint64_t>(records.data() + at + 1);
        const std::size_t next = at + kRecordHeader + size;
        if (next == records.size() || plausible(records, next, in_chunk) ||
            next_chained(records, at, in_chunk) > next) {
          take(static_cast<unsigned char>(records[at]), records.substr(at + kRecordHeader, size));
          at = next;
          continue;
        }
      } else if (cut_chunk(records, at, in_chunk)) {
        return;
      }
      const std::size_t next = next_chained(records, at, in_chunk);
      if (!in_chunk) log_.damage.bytes_lost += next - at;
      ++log_.damage.records_lost;
      at = next;
    }
  }

  [[nodiscard]] std::size_t next_chained(std::string_view records, std::size_t at, bool in_chunk) const {
    for (++at; at < records.size(); ++at)
      if (chained(records, at, in_chunk)) return at;
    return records.size();
  }

  /// The last chunk of a recording that was cut off.
  bool cut_chunk(std::string_view records, std::size_t at, bool in_chunk) {
    if (in_chunk || records.size() - at < kRecordHeader + kChunkSize ||
        static_cast<unsigned char>(records[at]) != kChunkRecord || fits(records, at))
      return false;
    const std::string_view body = records.substr(at + kRecordHeader);
    if (load_number<std::uint32_t>(body.data() + 28) > body.size() - kChunkSize ||
        next_chained(records, at, false) < records.size())
      return false;
    ++log_.damage.records_lost;
    take_chunk(body);
    return true;
  }

  void take(unsigned char op, std::string_view body) {
    switch (op) {
      case kSchemaRecord:
        return take_schema(body);
      case kChannelRecord:
        return take_channel(body);
      case kMessageRecord:
        return take_message(body);
      case kChunkRecord:
        return take_chunk(body);
      default:
        return;
    }
  }

  void take_schema(std::string_view body) {
    ByteReader fields(body);
    const auto id = fields.number<std::uint16_t>();
    Schema schema;
    schema.name = fields.text<std::uint32_t>();
    schema.encoding = fields.text<std::uint32_t>();
    schema.data = fields.text<std::uint32_t>();
    if (!fields.failed() && id != 0) schemas_.try_emplace(id, std::move(schema));
  }

  void take_channel(std::string_view body) {
    ByteReader fields(body);
    const auto id = fields.number<std::uint16_t>();
    if (topics_.size() <= id) topics_.resize(id + std::size_t{1}, kUnknown);
    if (topics_[id] != kUnknown) return;
    const auto schema_id = fields.number<std::uint16_t>();
    RosTopic topic;
    topic.name = fields.text<std::uint32_t>();
    topic.encoding = fields.text<std::uint32_t>();
    if (fields.failed()) return;
    if (const auto schema = schemas_.find(schema_id); schema != schemas_.end()) {
      topic.type = schema->second.name;
      topic.schema_encoding = schema->second.encoding;
      topic.schema = schema->second.data;
    }
    topics_[id] = messages_.topic(topic);
  }

  void take_message(std::string_view body) {
    const auto id = load_number<std::uint16_t>(body.data());
    const std::size_t topic = id < topics_.size() ? topics_[id] : kUnknown;
    if (topic == kUnknown) {
      ++unknown_channels_;
      ++log_.damage.records_lost;
      return;
    }
    messages_.add(topic, static_cast<Nanoseconds>(load_number<std::uint64_t>(body.data() + 6)),
                  body.substr(kMessageSize));
  }

  void take_chunk(std::string_view body) {
    ByteReader fields(body);
    (void)fields.bytes(16);  // first and last moment
    const auto size = fields.number<std::uint64_t>();
    const auto crc = fields.number<std::uint32_t>();
    const std::string_view compression = fields.text<std::uint32_t>();
    const auto packed_size = fields.number<std::uint64_t>();
    const std::string_view packed = fields.bytes(packed_size);
    const bool cut = fields.failed();
    // A file that unpacks to much more than recordings do keeps no one busy.
    const bool room = compression.empty() || size > kLargestChunk || unpacked_ + size <= most_unpacked();
    if (!compression.empty() && size <= kLargestChunk && room) unpacked_ += size;
    const UnpackedChunk chunk = room ? unpack_chunk(compression, packed, size, buffer_) : UnpackedChunk{};
    if (!chunk.sound || (!chunk.complete && !cut)) {
      lose_chunk(body);
      ++not_unpacked_;
      if (size > kLargestChunk) {
        reason_ = fmt::format(": more than {} MiB", kLargestChunk >> 20U);
      } else if (!room) {
        reason_ = fmt::format(": together with the others more than {} MiB", most_unpacked() >> 20U);
      } else if (!can_unpack(compression)) {
        reason_ = fmt::format(": compressed by {}", one_line(compression, 20));
      }
      return;
    }
    if (crc != 0 && chunk.complete && crc32(chunk.records) != crc) {
      lose_chunk(body);
      ++wrong_checksums_;
      return;
    }
    walk(chunk.records, true);
  }

  /// A hundred times the file, and 512 MiB of a small one.
  [[nodiscard]] std::uint64_t most_unpacked() const {
    return (512ULL << 20U) + 100ULL * static_cast<std::uint64_t>(bytes_.size());
  }

  void lose_chunk(std::string_view body) {
    log_.damage.bytes_lost += body.size();
    ++log_.damage.records_lost;
  }

  std::string_view bytes_;
  RosLog& messages_;
  Log& log_;
  std::map<std::uint16_t, Schema> schemas_;
  std::vector<std::size_t> topics_;  ///< by channel
  std::string buffer_;
  std::size_t wrong_checksums_ = 0, not_unpacked_ = 0;
  std::uint64_t unknown_channels_ = 0, unpacked_ = 0;
  std::string reason_;
  std::optional<std::uint64_t> counted_;
};

}  // namespace

void add_mcap(std::string_view bytes, RosLog& messages, Log& log) { McapReader(bytes, messages, log).run(); }

}  // namespace internal

bool is_mcap(std::string_view bytes) { return bytes.starts_with(internal::kMcapMagic); }

Log read_mcap(std::string_view bytes, std::string source) {
  Log log;
  log.source = std::move(source);
  log.format = "MCAP";
  if (bytes.empty()) throw InputError(log.source, "the file is empty");
  if (!is_mcap(bytes))
    throw InputError(log.source, "not an MCAP recording of version 0: it does not start with 89 4D 43 41 50 30 0D 0A");
  internal::RosLog messages;
  internal::add_mcap(bytes, messages, log);
  messages.finish(log);
  internal::finish(log);
  return log;
}

}  // namespace veridyn::io
