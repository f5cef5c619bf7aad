#include "veridyn/live/serial/pseudo_terminal.hpp"

#include <asm/termbits.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

#include "veridyn/core/error.hpp"

namespace veridyn::live {

PseudoTerminal::PseudoTerminal() : master_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
  char name[128];
  if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0 || ptsname_r(master_, name, sizeof name) != 0) {
    if (master_ >= 0) ::close(master_);
    throw InputError("/dev/ptmx", "the system gives no pseudo-terminal");
  }
  device_ = name;
  struct termios2 settings = {};
  if (ioctl(master_, TCGETS2, &settings) == 0) {
    settings.c_iflag = IGNBRK | IGNPAR;
    settings.c_oflag = 0;
    settings.c_lflag = 0;
    ioctl(master_, TCSETS2, &settings);
  }
}

PseudoTerminal::PseudoTerminal(const std::filesystem::path& name) : PseudoTerminal() {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::symlink_status(name, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_symlink(status))
    throw InputError(name.string(), "is there already, and no link to a pseudo-terminal");
  // A link of its own first, which then takes the name in one step.
  const std::filesystem::path fresh = name.string() + fmt::format(".{}", ::getpid());
  std::filesystem::remove(fresh, error);
  std::filesystem::create_symlink(device_, fresh, error);
  if (!error) std::filesystem::rename(fresh, name, error);
  if (error) throw InputError(name.string(), fmt::format("cannot be made: {}", error.message()));
  name_ = name;
}

PseudoTerminal::~PseudoTerminal() {
  std::error_code error;
  // Another program may have taken the name meanwhile.
  if (!name_.empty() && std::filesystem::read_symlink(name_, error) == device_) std::filesystem::remove(name_, error);
  ::close(master_);
}

std::vector<std::uint8_t> PseudoTerminal::read(std::size_t count) {
  std::vector<std::uint8_t> bytes(count);
  std::size_t have = 0;
  pollfd state = {.fd = master_, .events = POLLIN, .revents = 0};
  while (have < count && poll(&state, 1, 1000) > 0) {
    const std::size_t more = read_some(std::span(bytes).subspan(have));
    if (more == 0) break;
    have += more;
  }
  bytes.resize(have);
  return bytes;
}

std::size_t PseudoTerminal::read_some(std::span<std::uint8_t> out) {
  const ssize_t count = ::read(master_, out.data(), out.size());
  open_ = count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR));
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

std::size_t PseudoTerminal::write(std::span<const std::uint8_t> bytes) {
  std::size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t count = ::write(master_, bytes.data() + written, bytes.size() - written);
    if (count <= 0) break;
    written += static_cast<std::size_t>(count);
  }
  return written;
}

}  // namespace veridyn::live
