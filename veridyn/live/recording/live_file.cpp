#include "veridyn/live/recording/live_file.hpp"

#include <algorithm>

#include "veridyn/core/bytes.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/packets/crc32.hpp"

namespace veridyn::live {
namespace {

constexpr std::string_view kBlockStart = "BLK1", kHeadStart = "VLR1";
constexpr std::size_t kFrame = 12;                 // start, length, CRC
constexpr std::size_t kLargestBlock = 16U << 20U;  // [bytes]

/// Writes numbers and texts one after the other.
class RecordWriter {
 public:
  explicit RecordWriter(std::span<char> into) : into_(into) {}
  template <typename T>
  RecordWriter& add(T value) {
    put_at(into_, at_, value);
    at_ += sizeof value;
    return *this;
  }
  /// With its length before it, cut to what fits.
  RecordWriter& text(std::string_view text) {
    const std::size_t fits = std::min({text.size(), into_.size() - at_ - 2, std::size_t{0xffff}});
    add(static_cast<std::uint16_t>(fits));
    text.copy(into_.data() + at_, fits);
    at_ += fits;
    return *this;
  }
  [[nodiscard]] std::size_t size() const { return at_; }

 private:
  std::span<char> into_;
  std::size_t at_ = 0;
};

bool read_record(ByteReader& r, LiveRecord& record) {
  const auto kind = r.number<std::uint8_t>();
  record = {};
  record.kind = static_cast<LiveRecord::Kind>(kind);
  record.time = r.number<Nanoseconds>();
  switch (record.kind) {
    case LiveRecord::Kind::kDatagram: {
      const auto link = r.number<std::uint8_t>();
      if (link > static_cast<std::uint8_t>(LinkOf::kCamera)) return false;
      record.link = static_cast<LinkOf>(link);
      record.datagram.arrival = r.number<Nanoseconds>();
      record.datagram.sender.address = r.number<std::uint32_t>();
      record.datagram.sender.port = r.number<std::uint16_t>();
      record.datagram.bytes = r.text<std::uint16_t>();
      return !r.failed();
    }
    case LiveRecord::Kind::kRequest: {
      const auto request = r.number<std::uint8_t>();
      record.request = static_cast<OperatorRequest>(request);
      return !r.failed() && request <= static_cast<std::uint8_t>(OperatorRequest::kSignsWrong);
    }
    case LiveRecord::Kind::kKnob:
      record.knob = r.number<std::uint16_t>();
      record.count = r.number<std::uint16_t>();
      record.value = r.number<double>();
      return !r.failed();
    case LiveRecord::Kind::kStep:
    case LiveRecord::Kind::kCommand:
      record.sent = r.number<Nanoseconds>();
      record.order = r.text<std::uint16_t>();
      return !r.failed();
  }
  return false;
}

}  // namespace

std::size_t encode(const LiveRecord& record, std::span<char> into) {
  RecordWriter w(into);
  w.add(record.kind).add(record.time);
  switch (record.kind) {
    case LiveRecord::Kind::kDatagram:
      w.add(record.link).add(record.datagram.arrival).add(record.datagram.sender.address);
      w.add(record.datagram.sender.port).text(record.datagram.bytes);
      break;
    case LiveRecord::Kind::kRequest:
      w.add(record.request);
      break;
    case LiveRecord::Kind::kKnob:
      w.add(record.knob).add(record.count).add(record.value);
      break;
    case LiveRecord::Kind::kStep:
    case LiveRecord::Kind::kCommand:
      w.add(record.sent).text(record.order);
      break;
  }
  return w.size();
}

std::string encode(const LiveHead& head) {
  std::string bytes(kHeadStart);
  const auto add = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (const std::string* text : {&head.program, &head.study_name, &head.study}) {
    add(static_cast<std::uint32_t>(text->size()));
    bytes += *text;
  }
  add(head.started);
  add(head.started_utc);
  add(head.session);
  return bytes;
}

std::string framed(std::string_view content) {
  std::string block(kFrame, '\0');
  kBlockStart.copy(block.data(), kBlockStart.size());
  put_at(std::span(block), 4, static_cast<std::uint32_t>(content.size()));
  put_at(std::span(block), 8, io::crc32(content));
  block += content;
  return block;
}

bool for_each_record(std::string_view content, const std::function<void(const LiveRecord&)>& use) {
  ByteReader r(content);
  LiveRecord record;
  while (!r.ended()) {
    if (!read_record(r, record)) return false;
    use(record);
  }
  return true;
}

std::optional<LiveHead> decode_head(std::string_view content) {
  if (!content.starts_with(kHeadStart)) return std::nullopt;
  ByteReader r(content.substr(kHeadStart.size()));
  LiveHead head;
  head.program = r.text<std::uint32_t>();
  head.study_name = r.text<std::uint32_t>();
  head.study = r.text<std::uint32_t>();
  head.started = r.number<Nanoseconds>();
  head.started_utc = r.number<std::int64_t>();
  head.session = r.number<std::uint32_t>();
  if (r.failed()) return std::nullopt;
  return head;
}

std::optional<std::string_view> next_block(std::string_view bytes, std::size_t& at, bool grows, std::size_t& damaged) {
  while (at < bytes.size()) {
    const std::string_view rest = bytes.substr(at);
    if (rest.size() >= kFrame && rest.starts_with(kBlockStart)) {
      const std::size_t length = number_at<std::uint32_t>(rest, 4);
      const std::string_view content = rest.substr(kFrame, length);
      if (length <= kLargestBlock && content.size() == length &&
          io::crc32(content) == number_at<std::uint32_t>(rest, 8)) {
        at += kFrame + length;
        return content;
      }
      if (grows && length <= kLargestBlock && content.size() < length) return std::nullopt;
    }
    // Behind a damaged length the next block is looked for.
    const std::size_t next = rest.find(kBlockStart, 1);
    if (next == std::string_view::npos) break;
    ++damaged;
    at += next;
  }
  return std::nullopt;
}

LiveFile parse_live_file(std::string_view bytes, const std::string& name) {
  LiveFile file;
  bool has_head = false;
  std::size_t at = 0;
  while (const std::optional<std::string_view> content = next_block(bytes, at, false, file.damaged)) {
    if (auto head = has_head ? std::nullopt : decode_head(*content)) {
      file.head = std::move(*head);
      has_head = true;
    } else {
      file.blocks.emplace_back(*content);
    }
  }
  file.cut_bytes = bytes.size() - at;
  if (!has_head) throw InputError(name, "is no recording of a live run: it has no head");
  return file;
}

LiveFile read_live_file(const std::filesystem::path& path) {
  auto mapped = std::make_shared<const io::MappedFile>(path);
  LiveFile file = parse_live_file(mapped->bytes(), path.string());
  file.mapped = std::move(mapped);
  return file;
}

}  // namespace veridyn::live
