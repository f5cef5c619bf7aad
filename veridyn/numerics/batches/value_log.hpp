#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <span>
#include <unordered_map>
#include <vector>

namespace veridyn::numerics {

/// Values of a costly function, kept in a file as they are computed, so that a run which follows the same path as an
/// earlier one that was cut off is answered from it, with the same bits, as far as that came. For work whose next step
/// depends on the last; independent items are a `Batch`.
///
/// The file, little-endian: "veridyn values 1\n", then records of key and number of values (64 bits each), the values,
/// and a checksum (`Fingerprint`) of these. A record counts once it is whole: what a killed program leaves at the end
/// is dropped. Values stay in the file, not in memory.
class ValueLog {
 public:
  /// Opens or begins the file, which must not be written by another process.
  /// @throws InputError where it is no such log, or is damaged before its end; std::runtime_error where it cannot be
  /// written.
  explicit ValueLog(std::filesystem::path file);
  ValueLog(const ValueLog&) = delete;
  ValueLog& operator=(const ValueLog&) = delete;

  /// Reads the values under a key (a `Fingerprint` of the function and its arguments); false where there are none. On
  /// any thread. @throws std::runtime_error when the file cannot be read.
  [[nodiscard]] bool find(std::uint64_t key, std::vector<double>& values) const;
  /// On any thread; what is there already stays. @throws std::runtime_error when it cannot be written.
  void append(std::uint64_t key, std::span<const double> values);

  [[nodiscard]] std::size_t loaded() const { return loaded_; }  ///< records there when it was opened
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  struct Place {
    std::size_t offset = 0;  ///< of the first value
    std::size_t count = 0;   ///< of values
  };

  void load();

  std::filesystem::path path_;
  mutable std::mutex mutex_;
  mutable std::ifstream reader_;
  std::unordered_map<std::uint64_t, Place> places_;
  std::size_t size_ = 0;  ///< of the file [bytes]
  std::size_t loaded_ = 0;
};

}  // namespace veridyn::numerics
