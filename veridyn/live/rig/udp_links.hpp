#pragma once

#include <optional>

#include "veridyn/live/link/live_links.hpp"
#include "veridyn/live/link/udp_socket.hpp"
#include "veridyn/live/serial/serial_line.hpp"

namespace veridyn::live {

/// Telemetry in over UDP; orders out over UDP, with the platform's answers, or on a serial line, without.
class UdpLinks final : public LiveLinks {
 public:
  /// @throws InputError as `UdpSocket`
  UdpLinks(const Sender& telemetry, const Sender& platform);

  /// @throws InputError as `UdpSocket` and `SerialLine`
  UdpLinks(const Sender& telemetry, const SerialOptions& platform);

  std::optional<Incoming> next(Clock& clock, Nanoseconds until) override;
  bool send(std::string_view order) override;

 private:
  UdpSocket telemetry_;
  std::optional<UdpSocket> platform_;
  std::optional<SerialLine> line_;
};

}  // namespace veridyn::live
