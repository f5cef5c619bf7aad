#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "veridyn/live/serial/little_endian.hpp"
#include "veridyn/live/time/clock.hpp"

namespace veridyn::live {

struct SerialOptions {
  std::filesystem::path device;  ///< "/dev/ttyUSB0"
  int baud = 250'000;            ///< bit/s, any that the hardware can do, not only those that POSIX lists
};

/// A serial line, raw: 8 data bits, no parity, one stop bit, no flow control, nothing of the terminal's own. The line
/// belongs to this program while it is open: a second one is refused. Neither reading nor writing waits.
class SerialLine {
 public:
  /// @throws InputError in one line naming the device: absent, no right to open it, not a serial line, in use by
  /// another program, a baud rate that the line cannot do (2 % off count as done: frames of ten bits allow it)
  explicit SerialLine(const SerialOptions& options);
  ~SerialLine();
  SerialLine(SerialLine&& other) noexcept;
  SerialLine& operator=(SerialLine&& other) noexcept;
  SerialLine(const SerialLine&) = delete;
  SerialLine& operator=(const SerialLine&) = delete;

  /// What has come in, at most as much as `out` holds; 0 where nothing has, or the line hung up.
  std::size_t read(std::span<std::uint8_t> out);
  /// Hands bytes to the line; fewer where its buffer is full, 0 where it hung up.
  std::size_t write(Bytes bytes);
  /// Bytes that are still to go out; 0 where the driver does not say. A sender that waits for this to be small keeps
  /// the line's delay small.
  [[nodiscard]] std::size_t queued() const;
  /// Waits until something can be read, at most so long. @return whether something can
  bool wait(Nanoseconds at_most) const;
  /// The device is gone: unplugged, or the other side of a pseudo-terminal closed.
  [[nodiscard]] bool hung_up() const { return hung_up_; }
  /// File descriptor, to wait for it together with others.
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  void close();

  int descriptor_ = -1;
  bool hung_up_ = false;
};

namespace internal {
/// Why a line set to `got` cannot stand for one of `asked` bit/s; nothing where it can.
[[nodiscard]] std::optional<std::string> baud_refusal(int asked, long long got);
/// Why a device cannot be opened, in words, for an error number of `open`. @param group whose members may open it
[[nodiscard]] std::string open_refusal(int error, std::string_view group);
}  // namespace internal

}  // namespace veridyn::live
