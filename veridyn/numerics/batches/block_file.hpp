#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace veridyn::numerics {

/// Results of some items of a batch, one after the other.
struct Block {
  std::string batch;
  std::uint64_t fingerprint = 0;  ///< of the batch
  std::size_t first = 0;          ///< item
  std::vector<double> values;     ///< of `first` and those that follow
  double seconds = 0.0;           ///< processor time that they took
};

/// What stands under the name of a block.
enum class BlockState {
  kAbsent,
  kDamaged,     ///< no block, cut off, or changed
  kOtherBatch,  ///< whole, but of another fingerprint or other items
  kRead,
};

/// Writes a block as text, whole or not at all:
///
///     veridyn block 1
///     batch sampling, fingerprint 8a3c90e1d2f40b57
///     items 128 to 255
///     seconds 0.213
///     3f847ae147ae147b                  # the 64 bits of each value
///     ...
///     check 51b2ad9f03c7e846            # FNV-1a of all before it
///
/// @throws as `write_file`.
void write_block(const std::filesystem::path& path, const Block& block);

/// Reads a block into `block`, which says batch, fingerprint, first item and (by its size) number of values expected.
/// It is changed only when the block is read; every value then has the bits that were written, NaN too.
[[nodiscard]] BlockState read_block(const std::filesystem::path& path, Block& block);

}  // namespace veridyn::numerics
