#include "veridyn/live/rig/udp_links.hpp"

#include <poll.h>
#include <time.h>

#include <array>

namespace veridyn::live {

UdpLinks::UdpLinks(const Sender& telemetry, const Sender& platform)
    : telemetry_(telemetry, "live.telemetry"), platform_(UdpSocket::connected(platform, "live.platform")) {}

UdpLinks::UdpLinks(const Sender& telemetry, const SerialOptions& platform)
    : telemetry_(telemetry, "live.telemetry"), line_(platform) {}

bool UdpLinks::send(std::string_view order) {
  if (platform_) return platform_->send(order);
  // An order that would come late behind others is left out: the next one is newer.
  if (line_->queued() > order.size()) return false;
  return line_->write({reinterpret_cast<const std::uint8_t*>(order.data()), order.size()}) == order.size();
}

std::optional<Incoming> UdpLinks::next(Clock& clock, Nanoseconds until) {
  while (true) {
    const Nanoseconds left = until - clock.now();
    if (left <= 0) return std::nullopt;
    if (const auto d = telemetry_.receive()) return Incoming{LinkOf::kTelemetry, *d};
    if (const auto d = platform_ ? platform_->receive() : std::nullopt) return Incoming{LinkOf::kPlatform, *d};
    // A line has nothing to say: a handle below zero is not waited for.
    std::array<pollfd, 2> both = {
        {{telemetry_.handle(), POLLIN, 0}, {platform_ ? platform_->handle() : -1, POLLIN, 0}}};
    const timespec timeout{left / kSecond, left % kSecond};
    if (::ppoll(both.data(), both.size(), &timeout, nullptr) == 0) return std::nullopt;
  }
}

}  // namespace veridyn::live
