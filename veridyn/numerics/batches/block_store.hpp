#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/numerics/ranks/ranks.hpp"

namespace veridyn::numerics {

class SharedWork;

/// Independent items with a number each, or several, whatever they are.
struct Batch {
  std::string name;               ///< of its files: "sampling"
  std::uint64_t fingerprint = 0;  ///< of everything that its values follow from
  std::size_t items = 0;
  std::size_t items_per_block = 128;              ///< lost at most, for each thread, when the process is killed
  std::function<double(std::size_t)> value = {};  ///< of an item; on any thread
  std::size_t values_per_item = 1;
  /// Instead of `value`: fills all values of an item; on any thread.
  std::function<void(std::size_t, std::span<double>)> fill = {};
};

/// Which part of a work this process computes, of several that run whenever they like: items `index`, `index + count`,
/// ... Nothing waits for the others.
struct ProcessShare {
  std::size_t index = 0;  ///< below `count`
  std::size_t count = 1;  ///< 0: computes nothing, only reads what is there

  [[nodiscard]] bool computes(std::size_t item) const { return count > 0 && item % count == index; }
};

/// What came out of a batch.
struct BatchValues {
  std::vector<double> values;      ///< by item, those of an item together; complete only if `completed`
  double processor_seconds = 0.0;  ///< of all threads and processes, and of earlier runs that are continued
  /// False: the progress asked to stop, or blocks of other shares are missing (`BlockStore::missing`).
  bool completed = true;
};

/// Values of batches computed block by block; each finished block is a file in a folder, which makes long work
/// resumable: what has its block there is read, with the same bits, and not computed. Shares of it may be computed at
/// different times.
///
///     FOLDER/checkpoint.txt            what all batches follow from
///     FOLDER/sampling-000000.block     `write_block`
///
/// Files appear whole or not at all. Damaged ones are computed again. Of several processes that a launcher started all
/// compute, and the first alone reads and writes the folder.
class BlockStore {
 public:
  /// What the values follow from, by name: version, study, files. Lines may have the same name.
  using Identity = std::vector<std::pair<std::string, std::string>>;

  /// Keeps nothing and computes everything.
  BlockStore() = default;
  /// Keeps nothing, and computes everything together with the other processes.
  explicit BlockStore(Ranks ranks) : ranks_(std::move(ranks)) {}
  /// Opens or begins a folder.
  /// @throws InputError where it holds something else, or results of another identity: with the first line that
  /// differs; where it cannot be written.
  /// @param share  of the blocks of every batch
  /// @param ranks  with which every batch is computed; this process is their first
  BlockStore(std::filesystem::path folder, const Identity& identity, const ProcessShare& share = {}, Ranks ranks = {});

  /// Reads what is there of a batch, and computes its share of the rest on the progress' threads and in the other
  /// processes, all of which call it and return the same values. Values and their bits do not depend on share, threads,
  /// processes or earlier runs.
  /// @throws InputError where a block was computed from something else, or another process computes something else;
  /// std::runtime_error where the disk is full, or another process failed.
  [[nodiscard]] BatchValues compute(const Batch& batch, Progress& progress);

  /// Of all batches so far.
  [[nodiscard]] std::size_t blocks() const { return blocks_; }
  [[nodiscard]] std::size_t found() const { return found_; }  ///< when their batch began: of earlier runs or shares
  [[nodiscard]] std::size_t last_blocks() const { return last_blocks_; }  ///< of the last batch
  /// Of the last batch: what other shares have yet to compute. 0 too when the progress asked to stop.
  [[nodiscard]] std::size_t missing() const { return missing_; }
  /// Sentences: blocks that were damaged.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct Round;
  void open(const Identity& identity) const;
  [[nodiscard]] std::filesystem::path path_of(const Batch& batch, std::size_t block) const;
  /// Whether it is there; its values are then in the round.
  bool read(Round& round, std::size_t block, bool warn);
  /// Whether all were done.
  [[nodiscard]] bool compute_share(Round& round, SharedWork& work, Progress& progress) const;

  std::filesystem::path folder_;  ///< empty: keeps nothing
  ProcessShare share_;
  Ranks ranks_;
  std::vector<std::string> warnings_;
  std::size_t blocks_ = 0, found_ = 0, last_blocks_ = 0, missing_ = 0;
};

}  // namespace veridyn::numerics
