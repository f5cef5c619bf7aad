#include "veridyn/live/serial/serial_line.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "veridyn/core/error.hpp"

// The kernel's own names, for baud rates that are no constants (BOTHER); <termios.h> would define the same ones again.
#include <asm/termbits.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace veridyn::live {
namespace internal {

std::optional<std::string> baud_refusal(int asked, long long got) {
  if (got == asked) return std::nullopt;
  if (std::abs(static_cast<double>(got) / asked - 1.0) <= 0.02) return std::nullopt;
  return fmt::format("the line cannot do {} baud; the nearest it offers is {}", asked, got);
}

std::string open_refusal(int error, std::string_view group) {
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return "there is no such device; is it plugged in?";
    case EACCES:
    case EPERM:
      return fmt::format("no right to open it; members of the group '{}' have it", group);
    case EBUSY:
      return "in use by another program";
    case EISDIR:
      return "a folder, not a device";
    default:
      return fmt::format("cannot be opened: {}", std::strerror(error));
  }
}

}  // namespace internal

namespace {

/// Sets the line up; why not, where it cannot be.
std::optional<std::string> set_up(int descriptor, int baud) {
  struct termios2 settings = {};
  if (ioctl(descriptor, TCGETS2, &settings) != 0) return "not a serial line";
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 || ioctl(descriptor, TIOCEXCL) != 0) return "in use by another program";
  settings.c_iflag = IGNBRK | IGNPAR;
  settings.c_oflag = 0;
  settings.c_lflag = 0;
  settings.c_cflag = CS8 | CREAD | CLOCAL | BOTHER | (BOTHER << IBSHIFT);
  settings.c_ispeed = settings.c_ospeed = static_cast<speed_t>(baud);
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 0;
  if (ioctl(descriptor, TCSETS2, &settings) != 0 || ioctl(descriptor, TCGETS2, &settings) != 0)
    return fmt::format("the line cannot do {} baud: {}", baud, std::strerror(errno));
  // A driver takes the nearest rate that its clock can be divided to and says which.
  if (std::optional<std::string> refusal = internal::baud_refusal(baud, settings.c_ospeed)) return refusal;
  // What came in before is of no use, and may be of another rate.
  ioctl(descriptor, TCFLSH, TCIOFLUSH);
  return std::nullopt;
}

}  // namespace

SerialLine::SerialLine(const SerialOptions& options) {
  const std::string place = options.device.string();
  if (options.baud <= 0) throw InputError(place, fmt::format("baud is {}; must be > 0", options.baud));
  descriptor_ = ::open(options.device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor_ < 0) throw InputError(place, internal::open_refusal(errno, "dialout"));
  if (const std::optional<std::string> refusal = set_up(descriptor_, options.baud)) {
    close();
    throw InputError(place, *refusal);
  }
}

SerialLine::~SerialLine() { close(); }

SerialLine::SerialLine(SerialLine&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), hung_up_(other.hung_up_) {}

SerialLine& SerialLine::operator=(SerialLine&& other) noexcept {
  if (this != &other) {
    close();
    descriptor_ = std::exchange(other.descriptor_, -1);
    hung_up_ = other.hung_up_;
  }
  return *this;
}

void SerialLine::close() {
  if (descriptor_ < 0) return;
  ioctl(descriptor_, TIOCNXCL);
  ::close(descriptor_);
  descriptor_ = -1;
}

std::size_t SerialLine::read(std::span<std::uint8_t> out) {
  const ssize_t count = ::read(descriptor_, out.data(), out.size());
  if (count > 0) return static_cast<std::size_t>(count);
  // With VMIN = 0 an idle line reads as nothing, like one whose other end is gone: only poll distinguishes them.
  if (count < 0 && errno != EAGAIN && errno != EINTR) hung_up_ = true;
  if (count == 0 && !out.empty()) {
    pollfd state = {.fd = descriptor_, .events = POLLIN, .revents = 0};
    if (::poll(&state, 1, 0) > 0 && (state.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0) hung_up_ = true;
  }
  return 0;
}

std::size_t SerialLine::write(Bytes bytes) {
  const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
  if (count >= 0) return static_cast<std::size_t>(count);
  if (errno != EAGAIN && errno != EINTR) hung_up_ = true;
  return 0;
}

std::size_t SerialLine::queued() const {
  int bytes = 0;
  return ioctl(descriptor_, TIOCOUTQ, &bytes) == 0 && bytes > 0 ? static_cast<std::size_t>(bytes) : 0;
}

bool SerialLine::wait(Nanoseconds at_most) const {
  pollfd state = {.fd = descriptor_, .events = POLLIN, .revents = 0};
  const timespec time = {.tv_sec = at_most / kSecond, .tv_nsec = at_most % kSecond};
  return at_most >= 0 && ::ppoll(&state, 1, &time, nullptr) > 0 && (state.revents & POLLIN) != 0;
}

}  // namespace veridyn::live
