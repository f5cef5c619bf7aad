#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace veridyn::io {

/// The bytes of a file, mapped into memory where the file system allows it (pages are fetched as they are touched and
/// can be dropped again), otherwise read. A file that another program shortens meanwhile must not be opened this way.
class MappedFile {
 public:
  /// @throws InputError when the file is missing, a directory, empty, or cannot be read.
  explicit MappedFile(const std::filesystem::path& path);
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();

  [[nodiscard]] std::string_view bytes() const { return bytes_; }

 private:
  std::string_view bytes_;
  std::string owned_;
  void* mapped_ = nullptr;
};

}  // namespace veridyn::io
