#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <string_view>

#include "veridyn/live/time/clock.hpp"

namespace veridyn::live {

/// Who sent a datagram: IPv4 address and port, as they are read: 127.0.0.1 is 0x7f000001.
struct Sender {
  std::uint32_t address = 0;
  std::uint16_t port = 0;

  friend auto operator<=>(const Sender&, const Sender&) = default;
};

/// "127.0.0.1:4123".
[[nodiscard]] std::string to_string(const Sender& sender);
/// Whether it is reached from this machine only.
[[nodiscard]] constexpr bool is_loopback(const Sender& sender) { return sender.address >> 24U == 127; }

/// Where a datagram came in.
enum class LinkOf : std::uint8_t {
  kTelemetry = 0,
  kPlatform = 1,
  kCar = 2,     ///< bytes of a car's serial line
  kDriver = 3,  ///< records of wheel events; none: the driver is gone
  kCamera = 4,  ///< poses of the car from a camera above the track
};

/// What arrived, and when.
struct Datagram {
  std::string_view bytes;  ///< valid until the next one is asked for
  Sender sender;
  Nanoseconds arrival = 0;  ///< stamped by the kernel where it can, else when it was read
};

}  // namespace veridyn::live
