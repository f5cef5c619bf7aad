#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace veridyn::io {

/// View of one MAVLink packet, version 1 or 2.
struct MavlinkPacket {
  std::uint32_t message = 0;  ///< its id
  std::uint8_t system = 0, component = 0, sequence = 0;
  std::string_view payload = {};  ///< of version 2 without the zeros at its end
  std::size_t size = 0;           ///< of the packet [bytes]
  /// Whether the checksum is right; nothing where the message is not known, so that it cannot be checked.
  std::optional<bool> sound = {};
};

/// The packet that begins with the first byte; nothing where none does: wrong magic, bytes missing, features of version
/// 2 that are not known.
[[nodiscard]] std::optional<MavlinkPacket> mavlink_packet(std::string_view bytes);

}  // namespace veridyn::io
