#pragma once

#include <filesystem>

namespace veridyn::numerics {

/// A file that one process at a time may write: held until the end of the process, however it ends. Also between
/// machines, where the file system passes locks on.
class FileLock {
 public:
  /// Makes the file, empty, where there is none.
  /// @throws InputError where another process holds it; std::runtime_error where it cannot be opened.
  explicit FileLock(const std::filesystem::path& path);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace veridyn::numerics
