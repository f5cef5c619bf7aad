#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace veridyn::io::internal {

/// The clock of one sender in a telemetry log: its own stamps are moved to the receiver's time by the least delay.
///
/// Packets are told in the order in which they were received; afterwards each has its time.
class SenderClock {
 public:
  /// @param received  [s]  @param own  the sender's own stamp [s], where the message holds one
  void add(double received, std::optional<double> own);
  /// Of the packets in the order in which they were added [s].
  [[nodiscard]] std::vector<double> times() const;
  /// When the sender's clock restarted [s].
  [[nodiscard]] std::vector<double> restarts() const;

 private:
  /// A stretch without a restart.
  struct Epoch {
    double delay = 0.0;  ///< least of received less own
    double latest = 0.0;
    double first = 0.0;
  };
  struct Packet {
    double time = 0.0;       ///< own, or guessed of it; where there is no epoch as received
    std::int32_t kind = -1;  ///< of its clock; -1: as received
    std::size_t epoch = 0;
  };
  /// Stamps since the start of the sender and since 1970 are two clocks.
  struct Clock {
    std::vector<Epoch> epochs;
    double received = 0.0, own = 0.0;  ///< of the last packet
  };
  std::vector<Packet> packets_;
  Clock clocks_[2];
  std::int32_t last_kind_ = -1;
};

}  // namespace veridyn::io::internal
