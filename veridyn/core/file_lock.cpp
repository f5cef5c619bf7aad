#include "veridyn/core/file_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "veridyn/core/error.hpp"

namespace veridyn {

FileLock::FileLock(const std::filesystem::path& path)
    : descriptor_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) throw InputError(path.string(), fmt::format("cannot be opened: {}", std::strerror(errno)));
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(descriptor_);
    throw InputError(path.string(), "is in use by another run; wait for its end, or choose another folder");
  }
}

FileLock::~FileLock() { ::close(descriptor_); }

}  // namespace veridyn
