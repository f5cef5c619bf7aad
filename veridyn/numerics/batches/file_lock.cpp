#include "veridyn/numerics/batches/file_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "veridyn/core/error.hpp"

namespace veridyn::numerics {

FileLock::FileLock(const std::filesystem::path& path)
    : descriptor_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0)
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(errno)));
  // A file system without locks is no reason to refuse.
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(descriptor_);
    throw InputError(path.string(),
                     "is written by another process that runs; wait for its end, or choose another folder");
  }
}

FileLock::~FileLock() { ::close(descriptor_); }

}  // namespace veridyn::numerics
