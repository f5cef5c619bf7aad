#include "tests/live/serial/pseudo_terminal.hpp"

#include <asm/termbits.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <stdexcept>

namespace veridyn::live::testing {

PseudoTerminal::PseudoTerminal() : master_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
  if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0) throw std::runtime_error("no pseudo-terminal");
  char name[128];
  if (ptsname_r(master_, name, sizeof name) != 0) throw std::runtime_error("a pseudo-terminal without a name");
  device_ = name;
}

PseudoTerminal::~PseudoTerminal() { close(master_); }

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
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

void PseudoTerminal::write(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(master_, bytes.data(), bytes.size());
    if (count < 0) throw std::runtime_error("the pseudo-terminal takes no bytes");
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

int baud_of(int descriptor) {
  struct termios2 settings = {};
  return ioctl(descriptor, TCGETS2, &settings) == 0 ? static_cast<int>(settings.c_ospeed) : -1;
}

}  // namespace veridyn::live::testing
