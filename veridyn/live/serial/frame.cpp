#include "veridyn/live/serial/frame.hpp"

#include <algorithm>

#include "veridyn/io/packets/crc32.hpp"

namespace veridyn::live {
namespace {

static_assert(kLongestFrame - 1 <= 254, "one byte of stuffing is enough only for fewer than 254 bytes");

std::uint32_t crc_of(Bytes bytes) { return io::crc32({reinterpret_cast<const char*>(bytes.data()), bytes.size()}); }

/// Stuffs bytes[1..size) in place: bytes[0] and every zero become the distance to the next zero or the end.
void stuff(std::span<std::uint8_t> bytes) {
  std::size_t last = 0;
  for (std::size_t at = 1; at < bytes.size(); ++at) {
    if (bytes[at] != 0) continue;
    bytes[last] = static_cast<std::uint8_t>(at - last);
    last = at;
  }
  bytes[last] = static_cast<std::uint8_t>(bytes.size() - last);
}

/// Undoes it; false where a distance leads beyond the end. The bytes hold no zero.
bool unstuff(std::span<std::uint8_t> bytes) {
  std::size_t at = 0;
  while (at < bytes.size()) {
    const std::size_t distance = bytes[at];
    bytes[at] = 0;
    at += distance;
  }
  return at == bytes.size();
}

}  // namespace

std::size_t encode_frame(const FrameHeader& header, Bytes payload, std::span<std::uint8_t> out) {
  if (payload.size() > kLongestPayload || out.size() < frame_size(payload.size())) return 0;
  const std::span<std::uint8_t> content = out.subspan(1, kFrameHeader + payload.size());
  LittleEndianWriter write(content);
  write.put(kFrameVersion);
  write.put(header.kind);
  write.put(header.run);
  write.put(header.sequence);
  write.put(static_cast<std::uint8_t>(payload.size()));
  std::copy(payload.begin(), payload.end(), content.begin() + kFrameHeader);
  LittleEndianWriter(out.subspan(1 + content.size(), kFrameCheck)).put(crc_of(content));
  const std::size_t stuffed = 1 + content.size() + kFrameCheck;
  stuff(out.first(stuffed));
  out[stuffed] = 0;
  return stuffed + 1;
}

std::optional<SerialFrame> FrameDecoder::next(Bytes& bytes) {
  while (!bytes.empty()) {
    const auto zero = std::find(bytes.begin(), bytes.end(), std::uint8_t{0});
    const auto run = static_cast<std::size_t>(zero - bytes.begin());
    const std::size_t taken = std::min(run, buffer_.size() - size_);
    std::copy_n(bytes.begin(), taken, buffer_.begin() + size_);
    size_ += taken;
    overflowed_ = overflowed_ || taken < run;
    const bool ended = zero != bytes.end();
    const std::size_t used = run + (ended ? 1 : 0);
    counts_.bytes += used;
    bytes = bytes.subspan(used);
    if (!ended) continue;
    const std::optional<SerialFrame> frame = finish();
    size_ = 0;
    overflowed_ = false;
    if (frame) return frame;
  }
  return std::nullopt;
}

std::optional<SerialFrame> FrameDecoder::finish() {
  // Without its zero the longest frame has one byte less than the buffer.
  if (overflowed_ || size_ == buffer_.size()) {
    ++counts_.too_long;
    return std::nullopt;
  }
  if (size_ == 0) return std::nullopt;
  if (size_ < 1 + kFrameHeader + kFrameCheck || !unstuff(std::span(buffer_).first(size_))) {
    ++counts_.malformed;
    return std::nullopt;
  }
  const Bytes content = Bytes(buffer_).subspan(1, size_ - 1 - kFrameCheck);
  if (LittleEndianReader(Bytes(buffer_).subspan(size_ - kFrameCheck)).get<std::uint32_t>() != crc_of(content)) {
    ++counts_.bad_crc;
    return std::nullopt;
  }
  LittleEndianReader read(content);
  if (read.get<std::uint8_t>() != kFrameVersion) {
    ++counts_.other_version;
    return std::nullopt;
  }
  SerialFrame frame;
  frame.header.kind = read.get<std::uint8_t>();
  frame.header.run = read.get<std::uint16_t>();
  frame.header.sequence = read.get<std::uint32_t>();
  frame.payload = content.subspan(kFrameHeader);
  if (read.get<std::uint8_t>() != frame.payload.size()) {
    ++counts_.malformed;
    return std::nullopt;
  }
  ++counts_.good;
  return frame;
}

}  // namespace veridyn::live
