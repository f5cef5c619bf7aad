#pragma once

#include <filesystem>

namespace veridyn {

/// Keeps a file to one process, or one owner within it, for as long as it lives; makes the file where there is none. It
/// ends with the process, however that ends. Where the file system has no locks (some network ones) it guards nothing.
class FileLock {
 public:
  /// @throws InputError when another holds it or the file cannot be opened for writing.
  explicit FileLock(const std::filesystem::path& path);
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;
  ~FileLock();

 private:
  int descriptor_ = -1;
};

}  // namespace veridyn
