#pragma once

#include <cstdint>
#include <string_view>

namespace veridyn::io {

/// CRC-32 of IEEE 802.3, as zlib, gzip and Ethernet have it.
[[nodiscard]] std::uint32_t crc32(std::string_view bytes);

}  // namespace veridyn::io
