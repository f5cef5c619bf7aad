#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "veridyn/live/serial/little_endian.hpp"

namespace veridyn::live {

/// Frames on a line that flips, drops and inserts bytes. To the byte (docs/teleoperation.md):
///     version u8 | kind u8 | run u16 | sequence u32 | length u8 | payload | CRC-32 of all before it, u32
/// little-endian, then stuffed so that it holds no zero (COBS: Cheshire & Baker 1999, IEEE/ACM Trans. Netw. 7:159),
/// then one zero. A zero ends a frame and nothing else does: after any damage the decoder is in step again at the next
/// zero.
///
/// Why 32 bits: a damaged frame passes a check of n bits about once in 2^n, because stuffing turns one flipped bit into
/// errors in several places, so that no guaranteed distance is left. With 1 % of the bytes flipped a quarter to a half
/// of all frames is damaged: of 1e7 frames some 40 would pass 16 bits, 0.001 pass 32.
inline constexpr std::uint8_t kFrameVersion = 1;
/// Header and CRC [bytes].
inline constexpr std::size_t kFrameHeader = 9, kFrameCheck = 4;
/// Longest payload [bytes]. With it the whole frame is below 254 bytes, where stuffing takes exactly one byte.
inline constexpr std::size_t kLongestPayload = 128;
/// Bytes on the line for a payload of that length.
[[nodiscard]] constexpr std::size_t frame_size(std::size_t payload) { return kFrameHeader + payload + kFrameCheck + 2; }
inline constexpr std::size_t kLongestFrame = frame_size(kLongestPayload);

/// What identifies a frame.
struct FrameHeader {
  std::uint8_t kind = 0;
  std::uint16_t run = 0;       ///< of the sender: another one after each start
  std::uint32_t sequence = 0;  ///< counts the sender's frames of this kind, from any number, modulo 2^32

  bool operator==(const FrameHeader&) const = default;
};

/// A frame that passed all checks. The payload is a view into the decoder, until its next call.
struct SerialFrame {
  FrameHeader header;
  Bytes payload;
};

/// Writes a frame. Does not allocate or throw.
/// @return bytes written; 0 and nothing written where the payload is too long or `out` shorter than
/// `frame_size(payload.size())`
[[nodiscard]] std::size_t encode_frame(const FrameHeader& header, Bytes payload, std::span<std::uint8_t> out);

/// What a decoder has seen. Every run of bytes between two zeros is one of the frames below; runs of none are line
/// idle.
struct FrameCounts {
  std::uint64_t good = 0;
  std::uint64_t bad_crc = 0;
  std::uint64_t too_long = 0;   ///< no zero where the longest frame would have ended
  std::uint64_t malformed = 0;  ///< stuffing that points beyond the end; too short; a length that is not the payload's
  std::uint64_t other_version = 0;  ///< of a sender with another version of this format
  std::uint64_t bytes = 0;          ///< all that came in

  [[nodiscard]] std::uint64_t damaged() const { return bad_crc + too_long + malformed; }
};

/// Takes bytes in chunks of any size and gives the frames that are whole. Allocates nothing and never throws.
///
///     while (const std::optional<SerialFrame> frame = decoder.next(bytes)) use(*frame);
class FrameDecoder {
 public:
  /// Takes bytes from the front of `bytes` to the end of the next good frame, or all of them where there is none.
  [[nodiscard]] std::optional<SerialFrame> next(Bytes& bytes);
  [[nodiscard]] const FrameCounts& counts() const { return counts_; }

 private:
  [[nodiscard]] std::optional<SerialFrame> finish();

  std::array<std::uint8_t, kLongestFrame> buffer_ = {};
  std::size_t size_ = 0;
  bool overflowed_ = false;
  FrameCounts counts_;
};

}  // namespace veridyn::live
