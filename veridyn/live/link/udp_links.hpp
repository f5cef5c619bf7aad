#pragma once

#include "veridyn/live/link/live_links.hpp"
#include "veridyn/live/link/udp_socket.hpp"

namespace veridyn::live {

/// Telemetry in and orders out over UDP, with the platform's answers.
class UdpLinks final : public LiveLinks {
 public:
  /// @throws InputError as `UdpSocket`
  UdpLinks(const Sender& telemetry, const Sender& platform);

  std::optional<Incoming> next(Clock& clock, Nanoseconds until) override;
  bool send(std::string_view order) override { return platform_.send(order); }

 private:
  UdpSocket telemetry_, platform_;
};

}  // namespace veridyn::live
