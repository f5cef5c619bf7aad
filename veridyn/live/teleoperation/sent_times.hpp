#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "veridyn/live/teleoperation/car_command.hpp"

namespace veridyn::live {

/// When this end's last 512 frames were sent: what an echo of the other end is held against.
class SentTimes {
 public:
  void add(std::uint32_t sequence, Nanoseconds time) {
    sent_[sequence % sent_.size()] = {.sequence = static_cast<std::uint16_t>(sequence), .time = time, .used = true};
  }
  /// When the echoed frame was sent; nothing where it is none of the last ones.
  [[nodiscard]] std::optional<Nanoseconds> of(std::uint16_t sequence) const {
    const Sent& sent = sent_[sequence % sent_.size()];
    if (!sent.used || sent.sequence != sequence) return std::nullopt;
    return sent.time;
  }

 private:
  struct Sent {
    std::uint16_t sequence = 0;
    Nanoseconds time = 0;
    bool used = false;
  };
  std::array<Sent, 512> sent_ = {};
};

}  // namespace veridyn::live
