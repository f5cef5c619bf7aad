#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "veridyn/numerics/batches/companions.hpp"
#include "veridyn/numerics/batches/file_lock.hpp"
#include "veridyn/numerics/batches/process_share.hpp"

namespace veridyn::numerics {

/// Values of a costly function, kept in a file as they are computed, so that a run which follows the same path as an
/// earlier one that was cut off is answered from it, with the same bits, as far as that came. For work whose next step
/// depends on the last; independent items are a `Batch`.
///
/// Several processes that follow the same path share it: what the function is asked of at once are items with a number
/// each, of which a process computes its share and takes the others' from their files. Whoever computes them, all
/// processes see the same bits, so that their paths stay one.
///
///     FOLDER/evaluations.log      of a single process, or the first of several
///     FOLDER/evaluations-2.log    of the second
///
/// A file, little-endian: "veridyn values 1\n", then records of key and number of values (64 bits each), the values,
/// and a checksum (`Fingerprint`) of these. A record counts once it is whole: what a killed program leaves at the end
/// is dropped. Values stay in the files, not in memory. Those of earlier runs, with however many processes, count.
class ValueLog {
 public:
  /// Opens or begins this process' file in a folder.
  /// @param interrupted  ends the waiting for others; nullptr: nothing does
  /// @throws InputError where a file is no such log, or is damaged before its end, or another process that runs writes
  /// it; std::runtime_error where it cannot be written.
  explicit ValueLog(std::filesystem::path folder, const ProcessShare& share = {},
                    std::function<bool()> interrupted = nullptr);
  ValueLog(const ValueLog&) = delete;
  ValueLog& operator=(const ValueLog&) = delete;

  /// The values under a key (a `Fingerprint` of the function and its arguments). False: there are none, and this
  /// process has to compute them. On any thread.
  /// @param item  its number among what is asked at once; it is waited for where another process computes it
  /// @throws std::runtime_error when a file cannot be read or was changed, or a process that is waited for shows no
  /// life or computes nothing for long: then its path may be another one
  [[nodiscard]] bool find(std::uint64_t key, std::vector<double>& values, std::size_t item = 0) const;
  /// On any thread; what is there already stays. @throws std::runtime_error when it cannot be written.
  void append(std::uint64_t key, std::span<const double> values);

  [[nodiscard]] const ProcessShare& share() const { return share_; }
  [[nodiscard]] std::size_t loaded() const { return loaded_; }  ///< records there when it was opened
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  struct Place {
    std::size_t file = 0;    ///< of `files_`
    std::size_t offset = 0;  ///< of the first value
    std::size_t count = 0;   ///< of values
  };
  struct File {
    std::filesystem::path path;
    std::size_t size = 0;  ///< of the records read so far [bytes]
    std::ifstream reader = {};
  };

  void open_own();
  /// Those of other processes, also of earlier runs, that are not open yet.
  void open_others() const;
  /// Takes the whole records of what stands in a file behind those that were read. Not strict: a record that does not
  /// add up ends the reading instead of the program.
  void take_records(std::size_t file, std::string_view content, bool strict) const;
  /// Takes what was appended to a file since; true where that was a record. `reopen`: a network
  /// file system may show what others wrote only then.
  bool look_at(std::size_t file, bool reopen) const;
  [[nodiscard]] static std::string text_of(File& file, std::size_t offset, std::size_t size);
  [[nodiscard]] bool found(std::uint64_t key, std::vector<double>& values) const;
  /// False when interrupted, or when another thread failed.
  [[nodiscard]] bool wait_for(std::uint64_t key, std::vector<double>& values, std::size_t owner) const;
  /// One look of that; `patient`: it has lasted for a while.
  [[nodiscard]] bool has_come(std::uint64_t key, std::vector<double>& values, std::size_t owner, bool patient) const;
  void write_record(std::uint64_t key, std::span<const double> values);

  std::filesystem::path folder_;
  ProcessShare share_;
  std::function<bool()> interrupted_;
  std::size_t loaded_ = 0;
  mutable std::atomic<bool> failed_ = false;  ///< on some thread: nobody waits any more
  mutable std::mutex mutex_;
  mutable std::vector<File> files_;  ///< of process `index` at `index`, then those of earlier runs with more processes
  mutable std::unordered_map<std::uint64_t, Place> places_;
  mutable Companions companions_;
  std::unique_ptr<FileLock> lock_;
};

/// The values under a key: those of the log where it has them, else computed, and kept there.
/// @param log  nullptr: nothing is kept
/// @param fits  whether values of the log can be those of the function, by their number; those that cannot are computed
/// @param compute  the values, `std::vector<double>`; called at most once
template <typename Fits, typename Compute>
[[nodiscard]] std::vector<double> kept_or_computed(ValueLog* log, std::uint64_t key, std::size_t item, const Fits& fits,
                                                   const Compute& compute) {
  std::vector<double> values;
  if (log != nullptr && log->find(key, values, item) && fits(values.size())) return values;
  values = compute();
  if (log != nullptr) log->append(key, values);
  return values;
}

/// Of a log, or of work that keeps none and is not shared.
[[nodiscard]] inline ProcessShare share_of(const ValueLog* log) {
  return log == nullptr ? ProcessShare() : log->share();
}

}  // namespace veridyn::numerics
