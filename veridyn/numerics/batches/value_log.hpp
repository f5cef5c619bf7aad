#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "veridyn/core/file_lock.hpp"

namespace veridyn::numerics {

/// Values of a costly function, kept in a file as they are computed, so that a run which follows the same path as an
/// earlier one that was cut off is answered from it, with the same bits, as far as that came. For work whose next step
/// depends on the last; independent items are a `Batch`.
///
///     FOLDER/evaluations.log
///
/// The file, little-endian: "veridyn values 1\n", then records of key and number of values (64 bits each), the values,
/// and a checksum (`Fingerprint`) of these. A record counts once it is whole: what a killed program leaves at the end
/// is dropped. Values stay in the file, not in memory. It is kept to whoever has it open.
class ValueLog {
 public:
  /// Opens or begins the log in a folder.
  /// @throws InputError where a file is no such log, is damaged before its end, or is in use by another run;
  /// std::runtime_error where it cannot be written.
  explicit ValueLog(std::filesystem::path folder);
  ValueLog(const ValueLog&) = delete;
  ValueLog& operator=(const ValueLog&) = delete;

  /// The values under a key (a `Fingerprint` of the function and its arguments); false: there are none. On any thread.
  /// @throws std::runtime_error when the file cannot be read or was changed
  [[nodiscard]] bool find(std::uint64_t key, std::vector<double>& values) const;
  /// On any thread; what is there already stays. @throws std::runtime_error when it cannot be written.
  void append(std::uint64_t key, std::span<const double> values);

  [[nodiscard]] std::size_t loaded() const { return loaded_; }  ///< records there when it was opened
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  struct Place {
    std::size_t offset = 0;  ///< of the first value
    std::size_t count = 0;   ///< of values
  };

  /// Takes the whole records of the file.
  void take_records(std::string_view content);
  [[nodiscard]] std::string text_of(std::size_t offset, std::size_t size) const;

  std::filesystem::path folder_, path_;
  FileLock lock_;
  std::size_t size_ = 0;  ///< of the whole records [bytes]
  std::size_t loaded_ = 0;
  mutable std::mutex mutex_;
  mutable std::ifstream reader_;
  std::unordered_map<std::uint64_t, Place> places_;
};

/// The values under a key: those of the log where it has them, else computed, and kept there.
/// @param log  nullptr: nothing is kept
/// @param fits  whether values of the log can be those of the function, by their number; those that cannot are computed
/// @param compute  the values, `std::vector<double>`; called at most once
template <typename Fits, typename Compute>
[[nodiscard]] std::vector<double> kept_or_computed(ValueLog* log, std::uint64_t key, const Fits& fits,
                                                   const Compute& compute) {
  std::vector<double> values;
  if (log != nullptr && log->find(key, values) && fits(values.size())) return values;
  values = compute();
  if (log != nullptr) log->append(key, values);
  return values;
}

}  // namespace veridyn::numerics
