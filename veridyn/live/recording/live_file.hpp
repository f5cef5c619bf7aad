#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/io/log/mapped_file.hpp"
#include "veridyn/live/recording/live_record.hpp"

namespace veridyn::live {

// A file of a live run, `.vlr`, see docs/live.md: blocks, each "BLK1", its length, the CRC-32 of its content, the
// content: records one after the other. The first block holds the head. What is cut off anywhere can be read to the
// last whole block; a block that is damaged is left out.

/// What a run was of.
struct LiveHead {
  std::string program;           ///< and version
  std::string study;             ///< its text, after overrides
  std::string study_name;        ///< for messages
  Nanoseconds started = 0;       ///< by the run's clock
  std::int64_t started_utc = 0;  ///< the same moment in nanoseconds since 1970
  std::uint32_t session = 0;     ///< as the orders have it
};

/// The most bytes that a record takes.
inline constexpr std::size_t kLargestRecord = 2048;

/// The bytes of a record. @param into of kLargestRecord at least; a datagram that is longer than fits is cut
/// @return how many
std::size_t encode(const LiveRecord& record, std::span<char> into);
[[nodiscard]] std::string encode(const LiveHead& head);
/// A block with its frame.
[[nodiscard]] std::string framed(std::string_view content);

/// The records of a block's content, in order. @return whether all of it could be read
bool for_each_record(std::string_view content, const std::function<void(const LiveRecord&)>& use);

/// The content of the next whole block. Blocks that are damaged are passed over and counted.
/// @param at where in the bytes it is looked for; then behind it, or where the first one that is not whole begins
/// @param grows bytes are still to come: what is cut off is waited for
/// @return nothing where there is none
[[nodiscard]] std::optional<std::string_view> next_block(std::string_view bytes, std::size_t& at, bool grows,
                                                         std::size_t& damaged);
/// The head that a block holds; nothing where it holds none.
[[nodiscard]] std::optional<LiveHead> decode_head(std::string_view content);

/// What a file holds.
struct LiveFile {
  LiveHead head;
  std::vector<std::string_view> blocks;  ///< their contents, without the head
  std::size_t damaged = 0;               ///< blocks that were left out
  std::size_t cut_bytes = 0;             ///< at the end, of a block that is not whole
  /// What the blocks lie in: pages of the file that are fetched as they are read. Nothing where they lie elsewhere.
  std::shared_ptr<const io::MappedFile> mapped;
};

/// @param bytes of a whole file or of one that still grows, which the blocks are views of; @param name for messages
/// @throws InputError where there is no head: not such a file, or of another version
[[nodiscard]] LiveFile parse_live_file(std::string_view bytes, const std::string& name);
/// The same of a file, which is mapped: an hour at 2 kHz takes no memory of its own.
[[nodiscard]] LiveFile read_live_file(const std::filesystem::path& path);

}  // namespace veridyn::live
