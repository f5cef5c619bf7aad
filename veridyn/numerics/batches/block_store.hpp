#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/numerics/batches/companions.hpp"
#include "veridyn/numerics/batches/process_share.hpp"

namespace veridyn::numerics {

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

/// What came out of a batch.
struct BatchValues {
  std::vector<double> values;      ///< by item, those of an item together; complete only if `completed`
  double processor_seconds = 0.0;  ///< of all threads and processes, and of earlier runs that are continued
  /// False: the progress asked to stop, or blocks of others are missing (`BlockStore::missing`).
  bool completed = true;
};

/// Values of batches computed block by block; each finished block is a file in a folder, which makes long work
/// resumable and lets several processes share it: what has its block there is read, with the same bits, and not
/// computed.
///
///     FOLDER/checkpoint.txt            what all batches follow from
///     FOLDER/sampling-000000.block     `write_block`
///     FOLDER/process-1.alive           `Companions`: one of several processes
///
/// Files appear whole or not at all. Damaged ones are computed again.
class BlockStore {
 public:
  /// What the values follow from, by name: version, study, files. Lines may have the same name.
  using Identity = std::vector<std::pair<std::string, std::string>>;

  /// Keeps nothing and computes everything.
  BlockStore();
  /// Opens or begins a folder.
  /// @throws InputError where it holds something else, or results of another identity: with the first line that
  /// differs; where it cannot be written.
  /// @param share  of the blocks of every batch
  BlockStore(std::filesystem::path folder, const Identity& identity, const ProcessShare& share = {});
  ~BlockStore();
  BlockStore(BlockStore&&) noexcept;
  BlockStore& operator=(BlockStore&&) noexcept;

  /// Reads what is there of a batch, and computes this process' share of the rest on the progress' threads. Values and
  /// their bits do not depend on the share, the number of threads or earlier runs.
  /// @throws InputError where a block was computed from something else; std::runtime_error where a process that is
  /// waited for shows no life, or the disk is full.
  [[nodiscard]] BatchValues compute(const Batch& batch, Progress& progress);

  /// Of all batches so far.
  [[nodiscard]] std::size_t blocks() const { return blocks_; }
  [[nodiscard]] std::size_t found() const { return found_; }  ///< when their batch began: of earlier runs or others
  [[nodiscard]] std::size_t last_blocks() const { return last_blocks_; }  ///< of the last batch
  /// Of the last batch: what other processes have yet to compute. 0 too when the progress asked to stop.
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
  [[nodiscard]] bool compute_share(Round& round, Progress& progress) const;
  [[nodiscard]] bool wait_for_others(Round& round, Progress& progress);

  std::filesystem::path folder_;  ///< empty: keeps nothing
  ProcessShare share_;
  std::unique_ptr<Companions> companions_;
  std::vector<std::string> warnings_;
  std::size_t blocks_ = 0, found_ = 0, last_blocks_ = 0, missing_ = 0;
};

}  // namespace veridyn::numerics
