#include "veridyn/live/link/udp_links.hpp"

#include <poll.h>
#include <time.h>

#include <array>

namespace veridyn::live {

UdpLinks::UdpLinks(const Sender& telemetry, const Sender& platform)
    : telemetry_(telemetry, "live.telemetry"), platform_(UdpSocket::connected(platform, "live.platform")) {}

std::optional<Incoming> UdpLinks::next(Clock& clock, Nanoseconds until) {
  while (true) {
    const Nanoseconds left = until - clock.now();
    if (left <= 0) return std::nullopt;
    if (const auto d = telemetry_.receive()) return Incoming{LinkOf::kTelemetry, *d};
    if (const auto d = platform_.receive()) return Incoming{LinkOf::kPlatform, *d};
    std::array<pollfd, 2> both = {{{telemetry_.handle(), POLLIN, 0}, {platform_.handle(), POLLIN, 0}}};
    const timespec timeout{left / kSecond, left % kSecond};
    if (::ppoll(both.data(), both.size(), &timeout, nullptr) == 0) return std::nullopt;
  }
}

}  // namespace veridyn::live
