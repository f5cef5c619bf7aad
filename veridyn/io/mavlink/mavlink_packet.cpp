#include "veridyn/io/mavlink/mavlink_packet.hpp"

#include "veridyn/io/mavlink/mavlink_messages.hpp"

namespace veridyn::io {
namespace {

constexpr unsigned kMagic1 = 0xfe, kMagic2 = 0xfd;
constexpr std::size_t kHeader1 = 6, kHeader2 = 10, kChecksum = 2, kSignature = 13;
/// The only feature of version 2 that a reader must know.
constexpr unsigned kSigned = 1;

}  // namespace

std::optional<MavlinkPacket> mavlink_packet(std::string_view bytes) {
  const auto byte = [&](std::size_t at) -> unsigned { return static_cast<unsigned char>(bytes[at]); };
  if (bytes.size() < kHeader1 + kChecksum) return std::nullopt;
  const bool second = byte(0) == kMagic2;
  if (!second && byte(0) != kMagic1) return std::nullopt;
  const std::size_t length = byte(1), header = second ? kHeader2 : kHeader1;
  if (bytes.size() < header + length + kChecksum) return std::nullopt;
  MavlinkPacket out;
  out.size = header + length + kChecksum;
  if (second) {
    if ((byte(2) & ~kSigned) != 0) return std::nullopt;
    if ((byte(2) & kSigned) != 0) out.size += kSignature;
    if (bytes.size() < out.size) return std::nullopt;
    out.message = byte(7) | byte(8) << 8U | byte(9) << 16U;
  } else {
    out.message = byte(5);
  }
  const std::size_t sender = second ? 4 : 2;
  out.sequence = static_cast<std::uint8_t>(byte(sender));
  out.system = static_cast<std::uint8_t>(byte(sender + 1));
  out.component = static_cast<std::uint8_t>(byte(sender + 2));
  out.payload = bytes.substr(header, length);
  if (const MavlinkMessage* known = find_mavlink_message(out.message)) {
    const std::uint16_t crc = mavlink_crc(std::string_view(reinterpret_cast<const char*>(&known->crc_extra), 1),
                                          mavlink_crc(bytes.substr(1, header + length - 1)));
    out.sound = crc == (byte(header + length) | byte(header + length + 1) << 8U);
  }
  return out;
}

}  // namespace veridyn::io
