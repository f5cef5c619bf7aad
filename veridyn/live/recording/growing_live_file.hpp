#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>

#include "veridyn/live/recording/live_file.hpp"

namespace veridyn::live {

/// Reads a recording of a run while it is being written: each time what has come since, in whole blocks. It never holds
/// more of it in memory than it reads at a time.
class GrowingLiveFile {
 public:
  /// @throws InputError when it cannot be read
  explicit GrowingLiveFile(std::filesystem::path path);

  /// Hands the records of the next blocks over in order, at most some megabytes of them.
  /// @return whether there was anything; ask again until there is not
  /// @throws InputError where it is no recording of a live run, or became shorter
  bool read(const std::function<void(const LiveRecord&)>& use);

  /// Nothing until its first block is there.
  [[nodiscard]] const std::optional<LiveHead>& head() const { return head_; }
  /// Blocks that were passed over.
  [[nodiscard]] std::size_t damaged() const { return damaged_; }
  /// How much of the file has been read, 0 to 1.
  [[nodiscard]] double share() const;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  bool fetch();

  std::filesystem::path path_;
  std::ifstream file_;
  std::string bytes_;  ///< that were read and not yet handed over
  std::uintmax_t read_ = 0, size_ = 0;
  std::optional<LiveHead> head_;
  std::size_t damaged_ = 0;
};

}  // namespace veridyn::live
