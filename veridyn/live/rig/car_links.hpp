#pragma once

#include <array>
#include <memory>
#include <optional>

#include "veridyn/live/camera/pose_client.hpp"
#include "veridyn/live/driver/driver_source.hpp"
#include "veridyn/live/link/live_links.hpp"
#include "veridyn/live/link/udp_socket.hpp"
#include "veridyn/live/rig/live_study.hpp"
#include "veridyn/live/serial/serial_line.hpp"

namespace veridyn::live {

/// A car on a serial line, its driver, the platform over UDP, a socket for emergency stops and poses of a camera where
/// the study names them, waited for together. A line that hung up is opened again as soon as it is there, which is
/// tried twice a second.
class CarLinks final : public LiveLinks {
 public:
  /// @param study with a car
  /// @throws InputError as `SerialLine`, `UdpSocket`, `WheelDevice`, `read_wheel_events` and `read_driver_table`
  explicit CarLinks(const LiveStudy& study);

  std::optional<Incoming> next(Clock& clock, Nanoseconds until) override;
  bool send(std::string_view order) override { return platform_.send(order); }
  /// What the line does not take at once is dropped: a command that waits is of no use.
  bool send_command(std::string_view command) override;

 private:
  [[nodiscard]] std::optional<Incoming> from_line(Nanoseconds now);
  [[nodiscard]] std::optional<Incoming> from_driver(Nanoseconds now);
  void wait(Nanoseconds now, Nanoseconds until);
  void open_again(Nanoseconds now);

  SerialOptions line_options_;
  std::optional<SerialLine> line_;
  std::unique_ptr<DriverSource> driver_;
  UdpSocket platform_;
  std::optional<UdpSocket> stop_;
  std::optional<PoseClient> camera_;
  std::array<std::uint8_t, 512> chunk_ = {};
  std::size_t begin_ = 0, end_ = 0;  ///< of what was read of the line and not handed over
  Nanoseconds read_at_ = 0, tried_at_ = 0;
  std::array<std::uint8_t, 40 * WheelEventDecoder::kRecord> records_ = {};
  bool driver_gone_ = false;
};

}  // namespace veridyn::live
