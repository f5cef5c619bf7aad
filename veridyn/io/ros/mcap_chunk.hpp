#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace veridyn::io::internal {

/// The records of a chunk.
struct UnpackedChunk {
  std::string_view records;  ///< in the bytes that were given, or in the buffer
  bool complete = false;     ///< false where the compressed data end early; what could be had is there
  bool sound = false;        ///< false where they cannot be unpacked
};

/// The largest chunk that is unpacked [bytes]: recorders write 1 to 16 MiB.
inline constexpr std::uint64_t kLargestChunk = 256ULL << 20U;

/// Whether chunks that are compressed so can be unpacked: "", "lz4" (frames) or "zstd".
[[nodiscard]] bool can_unpack(std::string_view compression);

/// Unpacks a chunk of `size` bytes, at most `kLargestChunk`, into `buffer`.
[[nodiscard]] UnpackedChunk unpack_chunk(std::string_view compression, std::string_view packed, std::uint64_t size,
                                         std::string& buffer);

/// Unpacks one message that is compressed by zstd, of at most 64 MiB. False where it is none, or larger.
[[nodiscard]] bool unpack_zstd_message(std::string_view packed, std::string& buffer);
/// Whether bytes begin as data compressed by zstd do.
[[nodiscard]] bool is_zstd(std::string_view bytes);

}  // namespace veridyn::io::internal
