#include "veridyn/io/log/mapped_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::io {

MappedFile::MappedFile(const std::filesystem::path& path) {
  // Without O_NONBLOCK a pipe would be waited for until somebody writes into it.
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file >= 0) {
    struct stat status {};
    const bool known = ::fstat(file, &status) == 0;
    if (known && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode)) {
      ::close(file);
      throw InputError(path.string(), "is a device or a pipe, which has no end; expected a file");
    }
    if (known && S_ISREG(status.st_mode) && status.st_size > 0) {
      const auto size = static_cast<std::size_t>(status.st_size);
      void* const start = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
      if (start != MAP_FAILED) {
        mapped_ = start;
        bytes_ = std::string_view(static_cast<const char*>(start), size);
      }
    }
    ::close(file);
  }
  if (mapped_ == nullptr) {
    owned_ = read_file(path);
    bytes_ = owned_;
  }
  if (bytes_.empty()) throw InputError(path.string(), "the file is empty");
}

MappedFile::~MappedFile() {
  if (mapped_ != nullptr) ::munmap(mapped_, bytes_.size());
}

}  // namespace veridyn::io
